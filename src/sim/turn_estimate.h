/// Turning angles of cells: those that the mesh shows, and those that straight cells hide.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/fabric.h"
#include "mesh/active_mesh.h"
#include "mesh/edge_means.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Turning angle of cells. The bending cost of a triple, ½ B κ² A, enters as the angle κ l over the
/// cell, so one threshold suits any fabric, size and resolution. The middle of a cell is off the surface by
/// (κ + κ') l²/8, with the curvatures along warp and weft. So their sum counts as well where it is larger: in
/// bowls, and where cloth bends on the bias.
///
/// Cloth that is pulled round a solid presses on it with T κ, κ its curvature. Cells that turn by φ
/// make that tension wrong by about φ²/12, and with it friction. So the angle counts twice where
/// T κ is more than any weight that the cloth could carry.
///
/// A leaf is straight along its threads, whatever acts on it. A particle that was merged away would feel the
/// unbalanced load q [N/m²]: weight minus inertia and contact. With tension T and bending rigidity B the
/// middle of a span of length L takes the curvature q / (T + 8B/L²), so the cell would turn by
///
///     θ = q L / (T + 8B/L² + ½ ρ g L)
///
/// This angle is compared with the same thresholds as a visible turning angle. The last term is the
/// tension of a cell that hangs down: nothing turns further than that. For most fabrics only cells
/// above 30 mm can bend so much. A cell that would sag by no more than a few thicknesses counts as
/// stiff: finer cells would lie no better.
///
/// Waves that a probe makes in loose cloth return to it. A probe of radius r makes waves of length
/// λ = 4r and longer, with wave number k = 2π/λ. Cells of length L carry these too fast or too
/// slowly by (kL)²/24. The force F of the probe lacks that share of the load q λ² of the cloth that
/// swings with it. A hand distinguishes 5 to 7 %; 3 % leave room for other errors: q L² π²/6 < 0.03
/// F for any r. So the load of a cell, minus that of a finest cell, may be 2 % of the force; a
/// larger load makes a turning angle as well. A ring wave that has travelled three of its lengths
/// has a sixth of its strength when it returns, so cells farther away do not count.
///
/// A cell that is compressed along its threads stays straight where finer cells would buckle, above
/// the Euler load π² B/L² of a strip of its length. The compression over twice that load makes a turning
/// angle as well. A tenth of the cell's weight is added to the load: as much may come from a solve
/// that ends at its tolerance, and a fabric without bending rigidity has no Euler load. Compression
/// counts for some time after it is over: a fold that forms has relieved its cells, but it would
/// form differently if they merged.
class TurnEstimate {
 public:
  /// Probe that the cloth presses on.
  struct Touch {
    Vec3 position;  ///< [m]
    double radius;  ///< [m]
    double force;   ///< [N]
  };

  TurnEstimate(const Fabric& fabric, const Grid& grid, const Vec3& gravity);

  /// Inputs of begin() and turn(); all must outlive these calls.
  struct View {
    const ActiveMesh& mesh;
    const InternalEnergy& internal;
    const ContactSet& contacts;
    const Field& nodes;       ///< positions [m]
    const Field& velocities;  ///< [m/s]
    /// Gravity minus acceleration of the nodes, along the surface normal [m/s²].
    const std::vector<double>& weight;
    double look_time;  ///< time between two mesh decisions [s]
    const std::vector<Touch>& touches;
    /// Turn of a cell that misses kShare of the force, or is compressed by twice its Euler load [rad].
    double split_turn;
  };

  /// Measures tensions and curvatures for later calls of turn(); to be called once for each mesh decision.
  /// @param least smaller angles may count as zero [rad]
  void begin(const View& view, double least);

  /// Turning angle of a leaf (parts 1) or of the parent of four leaves (parts 2) [rad].
  /// @param enough larger angles may come out smaller, but not below this [rad]
  /// @pre begin() for the same mesh
  double turn(const View& view, const Cell& cell, int parts, double enough) const;

  /// Tells whether a leaf (parts 1) carries more than a share of the largest force of a probe or, if that is
  /// larger, of the weight of the cloth; or the parent of four leaves (parts 2) more than a quarter of that.
  /// Without a probe that touches, none does.
  /// @pre begin() for the same mesh
  bool carries(const View& view, const Cell& cell, int parts, double share) const;

  /// Saves or loads the compression of the particles.
  void serialize(Archive& archive);

 private:
  using Points = std::array<Vec3, 9>;

  void followCompression(const View& view, int direction);
  void measureCurvature(const View& view);
  double visible(const View& view, const Cell& cell, int parts) const;
  double turnUnder(double load, double tension, double length) const;
  double bend(const View& view, const Cell& cell, int parts) const;
  double missing(const View& view, const Cell& cell, int parts) const;
  double buckle(const View& view, const Cell& cell, int parts) const;
  double leastForce(const View& view, const Cell& cell) const;
  Points points(const View& view, const Cell& cell, int parts) const;
  double weightAround(const View& view, const Cell& cell) const;
  enum class Under { Nothing, Even, Uneven };
  Under under(const View& view, const Cell& cell, const Points& points) const;

  Grid grid_;
  double density_;                     ///< [kg/m²]
  double gravity_;                     ///< [m/s²]; standard gravity if a scene has none
  std::array<double, 2> rigidity_;     ///< of each direction [N·m]
  std::array<double, 2> compressive_;  ///< stiffness of each direction in compression [N/m]
  double range_;                       ///< gap at which contact begins [m]
  double weight_, width_;              ///< of the cloth; mean of both directions [N], [m]
  double least_ = 0.0;
  std::array<std::vector<double>, 2> tension_;  ///< mean of a node's edges by direction [N/m]
  /// Compression of each particle by direction, which falls slowly [N/m].
  std::array<std::vector<double>, 2> compression_;
  /// Largest of |κ|, |κ'|, each doubled where it counts twice, and |κ + κ'| at a node [1/m].
  std::vector<double> curvature_;
  std::vector<double> sum_;  ///< κ + κ' at a node [1/m], scratch
  EdgeMeans edge_means_;
};

}  // namespace haptic_cloth

/// xpbd_cloth: extended position based dynamics with small steps [Macklin et al. 2016, 2019],
/// written only for the bench and as plain as a user's own: one Gauss-Seidel pass over all
/// constraints per substep.
///   stretch   distance along warp and weft, stiffness the secant of the fabric's law
///   shear     distances along both diagonals of a cell
///   bending   x_l - 2 x_c + x_r on a thread [Kelager et al. 2010], quadratic in the curvature
///   contact   projection out of the solids, friction removes slip up to μ times the depth
///   layers    particle and triangle at least one thickness apart [Müller et al. 2007]; pairs from a
///             spatial hash once per frame, each on the side where it is then; friction as above
///   grasp     while the probe is closed, the particles that it touches keep their place at it
#include <algorithm>
#include <array>
#include <cmath>

#include "contact/solid.h"
#include "peer.h"

namespace haptic_cloth {
namespace peers {
namespace {

constexpr int kDefaultSubsteps = 20;
// Least arguments of a secant: strain, curvature [1/m], angle [rad].
constexpr double kLeastStrain = 1e-5, kLeastCurvature = 1e-2, kLeastAngle = 1e-4;

/// Secant stiffness of a law; one number per sign if the law is straight.
struct Stiffness {
  Stiffness(const Loop& a_law, double a_least, double scale_of_use) : law(a_law), least(a_least) {
    positive = secant(law, scale_of_use, least);
    negative = secant(law, -scale_of_use, least);
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(b); };
    straight = same(secant(law, 1e-3 * scale_of_use, 0.0), positive) &&
               same(secant(law, -1e-3 * scale_of_use, 0.0), negative);
  }
  double at(double s) const { return straight ? (s < 0.0 ? negative : positive) : secant(law, s, least); }

  Loop law;
  double least, positive, negative;
  bool straight;
};

struct Distance2 {
  int a, b;
  double length, width;  ///< stiffness [N/m] = width / length · secant
};

struct Bend {
  int l, c, r;
  double factor;  ///< stiffness [N/m] = factor · rigidity [N·m]
};

struct Touch {
  int particle, solid;
};

struct Patch4 {
  std::array<int, 4> corners;
};

/// A particle and a triangle that may meet. The particle stays on its side of the triangle.
struct LayerPair {
  int particle;
  std::array<int, 3> triangle;
  double side;  ///< 1 or -1
};

struct Held {
  int particle;
  Vec3 offset;  ///< from the proxy [m]
};

/// Weights of the corners a, b, c for the point of their triangle that is nearest to p.
std::array<double, 3> nearest(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double uu = ab.squaredNorm(), uv = ab.dot(ac), vv = ac.squaredNorm();
  const double pu = ab.dot(ap), pv = ac.dot(ap), det = uu * vv - uv * uv;
  if (det > 0.0) {
    const double s = (vv * pu - uv * pv) / det, t = (uu * pv - uv * pu) / det;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return {1.0 - s - t, s, t};
  }
  std::array<double, 3> best{1.0, 0.0, 0.0};
  double least = ap.squaredNorm();
  const std::array<const Vec3*, 3> corners{&a, &b, &c};
  for (int k = 0; k < 3; ++k) {
    const Vec3 &from = *corners[k], &to = *corners[(k + 1) % 3];
    const double length = (to - from).squaredNorm();
    const double s = length > 0.0 ? std::clamp((p - from).dot(to - from) / length, 0.0, 1.0) : 0.0;
    const double distance = (from + s * (to - from) - p).squaredNorm();
    if (distance > least) continue;
    least = distance;
    best = {0.0, 0.0, 0.0};
    best[k] = 1.0 - s;
    best[(k + 1) % 3] = s;
  }
  return best;
}

/// Points sorted by the cell of a uniform grid, found by a hash of the cell.
class SpatialHash {
 public:
  void fill(const std::vector<Vec3>& points, double cell) {
    cell_ = cell;
    const int count = static_cast<int>(points.size());
    first_.assign(2 * count + 1, 0);
    for (const Vec3& x : points) ++first_[bucket(at(x)) + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    entries_.resize(count);
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int p = 0; p < count; ++p) {
      const Cell c = at(points[p]);
      entries_[next[bucket(c)]++] = {p, c};
    }
  }

  template <class Visit>
  void forPointsIn(const Vec3& low, const Vec3& high, const Visit& visit) const {
    const Cell from = at(low), to = at(high);
    Cell c;
    for (c[0] = from[0]; c[0] <= to[0]; ++c[0]) {
      for (c[1] = from[1]; c[1] <= to[1]; ++c[1]) {
        for (c[2] = from[2]; c[2] <= to[2]; ++c[2]) {
          const std::size_t b = bucket(c);
          for (int k = first_[b]; k < first_[b + 1]; ++k) {
            if (entries_[k].cell == c) visit(entries_[k].point);
          }
        }
      }
    }
  }

 private:
  using Cell = std::array<int, 3>;
  struct Entry {
    int point;
    Cell cell;
  };

  Cell at(const Vec3& x) const {
    return {static_cast<int>(std::floor(x.x() / cell_)), static_cast<int>(std::floor(x.y() / cell_)),
            static_cast<int>(std::floor(x.z() / cell_))};
  }

  std::size_t bucket(const Cell& c) const {
    const auto hash = static_cast<unsigned>(c[0]) * 73856093u ^ static_cast<unsigned>(c[1]) * 19349663u ^
                      static_cast<unsigned>(c[2]) * 83492791u;
    return hash % (first_.size() - 1);
  }

  double cell_ = 1.0;
  std::vector<int> first_;
  std::vector<Entry> entries_;
};

class XpbdCloth : public Peer {
 public:
  XpbdCloth(const Scene& scene, double step, int substeps)
      : scene_(scene),
        columns_(scene.cloth.particles[kWarp]),
        rows_(scene.cloth.particles[kWeft]),
        dx_(scene.cloth.size[0] / (columns_ - 1)),
        dy_(scene.cloth.size[1] / (rows_ - 1)),
        frame_(step > 0.0 ? step : scene.solver.time_step),
        substeps_(substeps > 0 ? substeps : kDefaultSubsteps),
        h_(frame_ / substeps_),
        stretch_{Stiffness(scene.cloth.fabric.tensile[kWarp], kLeastStrain, 0.01),
                 Stiffness(scene.cloth.fabric.tensile[kWeft], kLeastStrain, 0.01)},
        bend_{Stiffness(scene.cloth.fabric.bending[kWarp], kLeastCurvature, 100.0),
              Stiffness(scene.cloth.fabric.bending[kWeft], kLeastCurvature, 100.0)},
        shear_(scene.cloth.fabric.shear, kLeastAngle, 0.05),
        solids_(scene.obstacles.begin(), scene.obstacles.end()),
        solid_moves_(solids_.size(), Vec3::Zero()),
        moved_(movedParticles(scene)),
        x_(flatCloth(scene)),
        before_(x_),
        v_(x_.size(), Vec3::Zero()) {
    const std::vector<double> masses = particleMasses(scene);
    const std::vector<char> pinned = pinnedParticles(scene);
    inverse_mass_.resize(masses.size());
    for (std::size_t p = 0; p < masses.size(); ++p) inverse_mass_[p] = pinned[p] ? 0.0 : 1.0 / masses[p];
    listEdges();
    listDiagonals();
    listBends();
    listTriangles();
  }

  double frame() const override { return frame_; }

  void step(const Vec3* device, const Vec3& device_velocity) override {
    if (device != nullptr && !present_) proxy_ = *device;
    present_ = device != nullptr;
    const double start = frames_++ * frame_;
    updateGrasp(start + frame_);
    findTouches(start);
    findLayers();
    force_ = Vec3::Zero();
    for (int k = 1; k <= substeps_; ++k) {
      moveSolids(start + k * h_);
      predict(start + k * h_);
      if (present_) predictProxy(*device - device_velocity * (h_ * (substeps_ - k)), device_velocity);
      for (int direction : {kWarp, kWeft}) solveStretch(direction);
      solveShear();
      for (int direction : {kWarp, kWeft}) solveBend(direction);
      solveLayers();
      solveSolids();
      if (present_) solveProbe();
      for (std::size_t p = 0; p < x_.size(); ++p) v_[p] = (x_[p] - before_[p]) / h_;
    }
    force_ /= substeps_;
  }

  void positions(std::vector<Vec3>& positions) const override { positions = x_; }
  Vec3 probe() const override { return proxy_; }
  Vec3 probeForce() const override { return force_; }

  nlohmann::json details() const override {
    return {{"method", "XPBD, one Gauss-Seidel pass a substep"},
            {"step", frame_},
            {"substeps", substeps_},
            {"most_layer_pairs", most_layers_}};
  }

 private:
  int particle(int i, int j) const { return j * columns_ + i; }

  /// Lists edges in two colours along the threads, so that neighbours in the list are independent.
  void listEdges() {
    for (int first : {0, 1}) {
      for (int j = 0; j < rows_; ++j) {
        const double width = dy_ * (j == 0 || j == rows_ - 1 ? 0.5 : 1.0);
        for (int i = first; i + 1 < columns_; i += 2) {
          edges_[kWarp].push_back({particle(i, j), particle(i + 1, j), dx_, width});
        }
      }
      for (int j = first; j + 1 < rows_; j += 2) {
        for (int i = 0; i < columns_; ++i) {
          const double width = dx_ * (i == 0 || i == columns_ - 1 ? 0.5 : 1.0);
          edges_[kWeft].push_back({particle(i, j), particle(i, j + 1), dy_, width});
        }
      }
    }
  }

  /// Lists diagonals. Two diagonals of stiffness G (a² + b²)/(2 a b) have the energy of a sheared
  /// cell to second order.
  void listDiagonals() {
    const double length = std::hypot(dx_, dy_);
    for (int first : {0, 1}) {
      for (int j = 0; j + 1 < rows_; ++j) {
        for (int i = first; i + 1 < columns_; i += 2) {
          diagonals_.push_back({particle(i, j), particle(i + 1, j + 1), length, 0.0});
          diagonals_.push_back({particle(i + 1, j), particle(i, j + 1), length, 0.0});
        }
      }
    }
  }

  /// Lists bends with ½ B w l κ² and κ = |x_l - 2 x_c + x_r|/l². It is twice that if the centre and
  /// a neighbour are pinned, as in the package, because the clamp acts over half a cell.
  void listBends() {
    const auto add = [this](int direction, int l, int c, int r, double length, double width) {
      const bool arm = (inverse_mass_[l] == 0.0 || inverse_mass_[r] == 0.0) && inverse_mass_[c] == 0.0;
      bends_[direction].push_back({l, c, r, (arm ? 2.0 : 1.0) * width / (length * length * length)});
    };
    for (int first : {1, 2, 3}) {
      for (int j = 0; j < rows_; ++j) {
        const double width = dy_ * (j == 0 || j == rows_ - 1 ? 0.5 : 1.0);
        for (int i = first; i + 1 < columns_; i += 3) {
          add(kWarp, particle(i - 1, j), particle(i, j), particle(i + 1, j), dx_, width);
        }
      }
      for (int j = first; j + 1 < rows_; j += 3) {
        for (int i = 0; i < columns_; ++i) {
          const double width = dx_ * (i == 0 || i == columns_ - 1 ? 0.5 : 1.0);
          add(kWeft, particle(i, j - 1), particle(i, j), particle(i, j + 1), dy_, width);
        }
      }
    }
  }

  /// Lists the two triangles of each cell; their diagonals change direction from cell to cell.
  void listTriangles() {
    for (int j = 0; j + 1 < rows_; ++j) {
      for (int i = 0; i + 1 < columns_; ++i) {
        const int a = particle(i, j), b = particle(i + 1, j), c = particle(i, j + 1),
                  d = particle(i + 1, j + 1);
        if ((i + j) % 2 == 0) {
          triangles_.insert(triangles_.end(), {{a, b, d}, {a, d, c}});
        } else {
          triangles_.insert(triangles_.end(), {{a, b, c}, {b, d, c}});
        }
      }
    }
  }

  void predict(double time) {
    const double slowed = 1.0 / (1.0 + scene_.air_damping * h_);
    for (std::size_t p = 0; p < x_.size(); ++p) {
      before_[p] = x_[p];
      if (inverse_mass_[p] > 0.0) x_[p] += h_ * slowed * (v_[p] + h_ * scene_.gravity);
    }
    for (const MovedParticle& moved : moved_) x_[moved.particle] = moved.position(time);
  }

  void moveSolids(double time) {
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      const Vec3 place = obstaclePosition(scene_.obstacles[s], time);
      solid_moves_[s] = place - solids_[s].position();
      solids_[s].place(place);
    }
  }

  /// A closed probe takes what it touches; an open one lets go.
  void updateGrasp(double time) {
    if (!present_ || !grasps(scene_, time)) held_.clear();
    if (!present_ || !grasps(scene_, time) || !held_.empty()) return;
    for (int p : touchedParticles(scene_, x_, proxy_)) {
      if (inverse_mass_[p] > 0.0) held_.push_back({p, x_[p] - proxy_});
    }
  }

  void solveGrasp() {
    for (const Held& held : held_) {
      const Vec3 push =
          (proxy_ + held.offset - x_[held.particle]) / (inverse_mass_[held.particle] + 1.0 / proxy_mass_);
      x_[held.particle] += inverse_mass_[held.particle] * push;
      proxy_ -= push / proxy_mass_;
    }
  }

  /// Finds the particles and triangles that may come within a thickness of each other in this frame.
  void findLayers() {
    layers_.clear();
    if (!scene_.cloth.self_contact) return;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& v : v_) mean += v / static_cast<double>(v_.size());
    double fastest = 0.0;
    for (const Vec3& v : v_) fastest = std::max(fastest, (v - mean).norm());
    const double close = scene_.cloth.fabric.thickness + 0.1 * std::min(dx_, dy_);
    hash_.fill(x_, std::max(dx_, dy_));
    for (const std::array<int, 3>& t : triangles_) {
      const Vec3 &a = x_[t[0]], &b = x_[t[1]], &c = x_[t[2]];
      double fast = 0.0;
      for (int k : t) fast = std::max(fast, (v_[k] - mean).norm());
      const Vec3 reach = Vec3::Constant(close + 2.0 * frame_ * (fast + fastest));
      hash_.forPointsIn(a.cwiseMin(b).cwiseMin(c) - reach, a.cwiseMax(b).cwiseMax(c) + reach, [&](int p) {
        if (p == t[0] || p == t[1] || p == t[2]) return;
        const std::array<double, 3> w = nearest(x_[p], a, b, c);
        const double range = close + 2.0 * frame_ * (fast + (v_[p] - mean).norm());
        if ((w[0] * a + w[1] * b + w[2] * c - x_[p]).squaredNorm() > range * range) return;
        layers_.push_back({p, t, (x_[p] - a).dot((b - a).cross(c - a)) < 0.0 ? -1.0 : 1.0});
      });
    }
    most_layers_ = std::max(most_layers_, layers_.size());
  }

  /// Moves particle and triangle apart to one thickness: along the triangle's normal above its inside, along
  /// their distance beside it.
  void solveLayers() {
    const double thickness = scene_.cloth.fabric.thickness;
    for (const LayerPair& pair : layers_) {
      const std::array<int, 3>& t = pair.triangle;
      const std::array<double, 3> weights = nearest(x_[pair.particle], x_[t[0]], x_[t[1]], x_[t[2]]);
      const auto point = [&](const std::vector<Vec3>& x) {
        return Vec3(weights[0] * x[t[0]] + weights[1] * x[t[1]] + weights[2] * x[t[2]]);
      };
      const Vec3 away = x_[pair.particle] - point(x_);
      Vec3 normal = away;
      if (weights[0] > 0.0 && weights[1] > 0.0 && weights[2] > 0.0) {
        normal = pair.side * (x_[t[1]] - x_[t[0]]).cross(x_[t[2]] - x_[t[0]]);
      }
      const double length = normal.norm();
      if (!(length > 0.0)) continue;
      normal /= length;
      const double depth = thickness - away.dot(normal);
      if (!(depth > 0.0)) continue;
      double w = inverse_mass_[pair.particle];
      for (int c = 0; c < 3; ++c) w += weights[c] * weights[c] * inverse_mass_[t[c]];
      if (w == 0.0) continue;
      const Vec3 moved = away - (before_[pair.particle] - point(before_));
      const Vec3 slip = moved - moved.dot(normal) * normal;
      const double limit = scene_.cloth.self_friction * depth, slid = slip.norm();
      const Vec3 push = (depth * normal - slip * (slid > limit ? limit / slid : 1.0)) / w;
      x_[pair.particle] += inverse_mass_[pair.particle] * push;
      for (int c = 0; c < 3; ++c) {
        x_[t[c]] -= inverse_mass_[t[c]] * weights[c] * push;
      }
    }
  }

  /// Predicts the massless proxy over a substep: a particle of mass h² k + h b at the place where
  /// spring and damper alone would put it.
  void predictProxy(const Vec3& device, const Vec3& device_velocity) {
    const double k = scene_.probes[0].coupling_stiffness, b = scene_.probes[0].coupling_damping;
    proxy_mass_ = h_ * (h_ * k + b);
    proxy_before_ = proxy_;
    proxy_ += (h_ * h_ * k * (device - proxy_) + h_ * b * h_ * device_velocity) / proxy_mass_;
    proxy_free_ = proxy_;
  }

  void pull(int a, int b, double rest, double stiffness) {
    const double w = inverse_mass_[a] + inverse_mass_[b];
    if (w == 0.0 || !(stiffness > 0.0)) return;
    const Vec3 d = x_[b] - x_[a];
    const double length = d.norm();
    if (!(length > 0.0)) return;
    const Vec3 move = (length - rest) / (length * (w + 1.0 / (stiffness * h_ * h_))) * d;
    x_[a] += inverse_mass_[a] * move;
    x_[b] -= inverse_mass_[b] * move;
  }

  void solveStretch(int direction) {
    const Stiffness& law = stretch_[direction];
    for (const Distance2& e : edges_[direction]) {
      const double strain = (x_[e.b] - x_[e.a]).norm() / e.length - 1.0;
      pull(e.a, e.b, e.length, law.at(strain) * e.width / e.length);
    }
  }

  void solveShear() {
    const double area = dx_ * dy_, square = dx_ * dx_ + dy_ * dy_;
    for (const Distance2& e : diagonals_) {
      const double modulus = shear_.straight
                                 ? shear_.positive
                                 : shear_.at(((x_[e.b] - x_[e.a]).norm() - e.length) * e.length / area);
      pull(e.a, e.b, e.length, modulus * square / (2.0 * area));
    }
  }

  void solveBend(int direction) {
    const Stiffness& law = bend_[direction];
    const double spacing = direction == kWarp ? dx_ : dy_;
    for (const Bend& t : bends_[direction]) {
      const double wl = inverse_mass_[t.l], wc = inverse_mass_[t.c], wr = inverse_mass_[t.r];
      const double w = wl + 4.0 * wc + wr;
      const Vec3 d = x_[t.l] - 2.0 * x_[t.c] + x_[t.r];
      const double rigidity = law.straight ? law.positive : law.at(d.norm() / (spacing * spacing));
      if (w == 0.0 || !(rigidity > 0.0)) continue;
      const Vec3 move = d / (w + 1.0 / (rigidity * t.factor * h_ * h_));
      x_[t.l] -= wl * move;
      x_[t.c] += 2.0 * wc * move;
      x_[t.r] -= wr * move;
    }
  }

  /// Finds the particles and cells that may touch solids within this frame.
  void findTouches(double start) {
    touches_.clear();
    std::vector<double> moves;  // of the solids within the frame [m]
    for (const Obstacle& obstacle : scene_.obstacles) {
      moves.push_back(
          (obstaclePosition(obstacle, start + frame_) - obstaclePosition(obstacle, start)).norm());
    }
    const double fall = frame_ * frame_ * scene_.gravity.norm(), thickness = scene_.cloth.fabric.thickness;
    for (int p = 0; p < static_cast<int>(x_.size()); ++p) {
      if (inverse_mass_[p] == 0.0) continue;
      const double reach = thickness + 2.0 * (frame_ * v_[p].norm() + fall) + 0.1 * std::min(dx_, dy_);
      for (int s = 0; s < static_cast<int>(solids_.size()); ++s) {
        if (solids_[s].distance(x_[p]).value < reach + moves[s]) touches_.push_back({p, s});
      }
    }
    patches_.clear();
    if (!present_) return;
    const double reach = scene_.probes[0].radius + 2.0 * std::hypot(dx_, dy_) + 2.0 * frame_;
    for (int j = 0; j + 1 < rows_; ++j) {
      for (int i = 0; i + 1 < columns_; ++i) {
        const std::array<int, 4> c{particle(i, j), particle(i + 1, j), particle(i, j + 1),
                                   particle(i + 1, j + 1)};
        if ((x_[c[0]] - proxy_).norm() < reach) patches_.push_back({c});
      }
    }
  }

  void solveSolids() {
    for (const Touch& touch : touches_) {
      Vec3& x = x_[touch.particle];
      const Distance d = solids_[touch.solid].distance(x);
      const double depth = scene_.cloth.fabric.thickness - d.value;
      if (!(depth > 0.0)) continue;
      x += depth * d.normal;
      const Vec3 moved = x - before_[touch.particle] - solid_moves_[touch.solid];
      const Vec3 slip = moved - moved.dot(d.normal) * d.normal;
      const double limit = solids_[touch.solid].friction() * depth, length = slip.norm();
      x -= slip * (length > limit ? limit / length : 1.0);
    }
  }

  /// Contact of the probe with points of the surface at most a third of the radius apart, as in the
  /// package.
  void solveProbe() {
    const int nu = std::max(1, static_cast<int>(std::ceil(3.0 * dx_ / scene_.probes[0].radius)));
    const int nv = std::max(1, static_cast<int>(std::ceil(3.0 * dy_ / scene_.probes[0].radius)));
    for (const Patch4& patch : patches_) {
      for (int b = 0; b < nv; ++b) {
        for (int a = 0; a < nu; ++a) touchProbe(patch, (a + 0.5) / nu, (b + 0.5) / nv);
      }
    }
    solveGrasp();
    force_ += proxy_mass_ / (h_ * h_) * (proxy_ - proxy_free_);
  }

  void touchProbe(const Patch4& patch, double u, double v) {
    const std::array<double, 4> weights{(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    Vec3 point = Vec3::Zero(), start = Vec3::Zero();
    double w = 1.0 / proxy_mass_;
    for (int k = 0; k < 4; ++k) {
      point += weights[k] * x_[patch.corners[k]];
      start += weights[k] * before_[patch.corners[k]];
      w += weights[k] * weights[k] * inverse_mass_[patch.corners[k]];
    }
    const Vec3 away = point - proxy_;
    const double length = away.norm();
    const double depth = scene_.probes[0].radius + scene_.cloth.fabric.thickness - length;
    if (!(depth > 0.0) || !(length > 0.0)) return;
    const Vec3 normal = away / length;
    const Vec3 moved = (point - start) - (proxy_ - proxy_before_);
    const Vec3 slip = moved - moved.dot(normal) * normal;
    const double limit = scene_.probes[0].friction * depth, slid = slip.norm();
    const Vec3 push = (depth * normal - slip * (slid > limit ? limit / slid : 1.0)) / w;
    for (int k = 0; k < 4; ++k) {
      x_[patch.corners[k]] += inverse_mass_[patch.corners[k]] * weights[k] * push;
    }
    proxy_ -= push / proxy_mass_;
  }

  Scene scene_;
  int columns_, rows_;
  double dx_, dy_;
  double frame_;
  int substeps_;
  double h_;
  std::array<Stiffness, 2> stretch_, bend_;
  Stiffness shear_;
  std::vector<Solid> solids_;
  std::vector<Vec3> solid_moves_;  ///< within the substep [m]
  std::vector<MovedParticle> moved_;
  std::vector<Vec3> x_, before_, v_;
  std::vector<double> inverse_mass_;
  std::array<std::vector<Distance2>, 2> edges_;
  std::vector<Distance2> diagonals_;
  std::array<std::vector<Bend>, 2> bends_;
  std::vector<Touch> touches_;
  std::vector<Patch4> patches_;
  std::vector<std::array<int, 3>> triangles_;
  SpatialHash hash_;
  std::vector<LayerPair> layers_;
  std::size_t most_layers_ = 0;
  std::vector<Held> held_;
  int frames_ = 0;
  bool present_ = false;
  double proxy_mass_ = 1.0;
  Vec3 proxy_ = Vec3::Zero(), proxy_before_ = Vec3::Zero(), proxy_free_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();
};

}  // namespace
}  // namespace peers
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  using namespace haptic_cloth;  // a separate main
  return peers::runPeer(argc, argv, "xpbd_cloth", "XPBD with small steps, written for the bench.",
                        [](const Scene& scene, const peers::Arguments& arguments) {
                          return std::make_unique<peers::XpbdCloth>(scene, arguments.step,
                                                                    arguments.substeps);
                        });
}

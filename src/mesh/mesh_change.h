/// Elements that survive a change of the mesh.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

constexpr int kNew = -1;  ///< index before a change, for an element that is new

/// Elements of one kind before and after a change.
template <class Element>
struct Followed {
  std::vector<Element> before;  ///< with node numbers from before the change
  std::vector<char> stays;      ///< for each element before: it survives
  /// For each element after: its index before, or kNew.
  std::vector<int> was;

  /// Tells whether an element is new. All are new if no change was compared.
  bool isNew(int now) const { return now >= static_cast<int>(was.size()) || was[now] == kNew; }

  void reserve(std::size_t capacity) {
    before.reserve(capacity);
    stays.reserve(capacity);
    was.reserve(capacity);
  }
  void begin(const std::vector<Element>& elements) {
    before = elements;
    stays.assign(elements.size(), 0);
    was.clear();
  }
  /// @param found index before of the next element after the change
  void add(int found) {
    was.push_back(found);
    if (found != kNew) stays[found] = 1;
  }
};

/// Compares elements before and after a change. An element survives if it acts on the same
/// particles, which have not moved, with the same weights; all others are new. Most changes touch a
/// few cells, and elements far from these need no update.
class MeshChange {
 public:
  /// Reserves memory for the finest mesh.
  explicit MeshChange(const ActiveMesh& mesh);

  /// Records the elements. @param x positions of the nodes [m]
  void begin(const ActiveMesh& mesh, const Field& x);

  /// Compares the recorded elements with those of the changed mesh.
  void end(const ActiveMesh& mesh, const Field& x);

  const Followed<Edge>& edges() const { return edges_; }
  const Followed<Triple>& triples() const { return triples_; }
  const Followed<Patch>& patches() const { return patches_; }
  const Field& positions() const { return positions_; }  ///< positions of the nodes before [m]

 private:
  void followNodes(const ActiveMesh& mesh, const Field& x);
  int find(const Edge& edge) const;
  int find(const Triple& triple) const;
  int find(const Patch& patch) const;

  Followed<Edge> edges_;
  Followed<Triple> triples_;
  Followed<Patch> patches_;
  Field positions_;
  std::vector<int> particle_;  ///< particle of each node before
  std::vector<int> number_;    ///< node before of each particle; valid if particle_ agrees
  /// Indices by direction and node before.
  std::array<std::vector<int>, 2> first_edge_, triple_at_;
  std::vector<int> patch_at_;  ///< index by the lower left node before
  /// Node before of each node after; kNew also if it moved.
  std::vector<int> node_was_;
};

}  // namespace haptic_cloth

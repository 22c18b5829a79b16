/// Which elements outlast a change of the mesh.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

constexpr int kNew = -1;  ///< in place of the index before a change: there was none

/// The elements of one kind on both sides of a change.
template <class Element>
struct Followed {
  std::vector<Element> before;  ///< by the nodes of then
  std::vector<char> stays;      ///< of an element before: it is still there
  std::vector<int> was;         ///< of an element of now: its index before, kNew: it was not there

  /// Of an element of now. Without a look at the change all are new.
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
  /// @param found index before of the next element of now
  void add(int found) {
    was.push_back(found);
    if (found != kNew) stays[found] = 1;
  }
};

/// An element outlasts a change if it acts on the same particles, which have not moved, with the same
/// weights. All others are new. Most changes touch a few cells, and what is far from these need not be looked
/// at again.
class MeshChange {
 public:
  /// With room for the finest mesh.
  explicit MeshChange(const ActiveMesh& mesh);

  /// Writes the elements down. @param x positions of the nodes [m]
  void begin(const ActiveMesh& mesh, const Field& x);

  /// Compares with the mesh as it is now.
  void end(const ActiveMesh& mesh, const Field& x);

  const Followed<Edge>& edges() const { return edges_; }
  const Followed<Triple>& triples() const { return triples_; }
  const Followed<Patch>& patches() const { return patches_; }
  const Field& positions() const { return positions_; }  ///< of the nodes before [m]

 private:
  void followNodes(const ActiveMesh& mesh, const Field& x);
  int find(const Edge& edge) const;
  int find(const Triple& triple) const;
  int find(const Patch& patch) const;

  Followed<Edge> edges_;
  Followed<Triple> triples_;
  Followed<Patch> patches_;
  Field positions_;
  std::vector<int> particle_;  ///< of a node of then
  std::vector<int> number_;    ///< node of then of a particle, where particle_ says the same
  std::array<std::vector<int>, 2> first_edge_, triple_at_;  ///< by direction and node of then
  std::vector<int> patch_at_;                               ///< by its lower left node of then
  std::vector<int> node_was_;                               ///< of a node of now; kNew also if it moved
};

}  // namespace haptic_cloth

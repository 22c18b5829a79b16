/// Gathering of element results at the nodes: each element writes vectors to slots of its own, each
/// node sums its slots in a fixed order. So no thread waits for another, and the bits do not depend
/// on the number of threads.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Numbering of the elements of one kind: warp first, each direction padded to whole packs.
struct PackedRange {
  int warp = 0, weft = 0;  ///< number of elements

  int count() const { return warp + weft; }
  int direction(int element) const { return element < warp ? kWarp : kWeft; }
  int warpEnd() const { return padded(warp); }
  int size() const { return padded(warp) + padded(weft); }
  /// Padded position of an element. @param element index in the list of the mesh, which has warp
  /// first
  int place(int element) const { return element < warp ? element : element - warp + padded(warp); }
};

/// One slot for each node of a pack. If the slots are consecutive and all nodes have the same
/// coefficient, two numbers describe them; otherwise `detail` does.
struct GatherColumn {
  int first;
  int detail;  ///< -1: none
  double coefficient;
};
struct alignas(32) GatherDetail {
  double coefficient[kPack];
  PackIndices slots;
};

class NodeGather {
 public:
  /// Kinds of elements that have an effect; the others get no entries.
  struct Kinds {
    bool bending, shear, twist;
  };

  NodeGather(const ActiveMesh& mesh, const Kinds& kinds);

  /// Must follow a change of the mesh.
  void rebuild(const ActiveMesh& mesh);

  /// Slots in order: edges, triples, rising sides of patches, their falling sides, their twists.
  const PackedRange& edges() const { return edges_; }
  const PackedRange& triples() const { return triples_; }
  const PackedRange& patches() const { return patches_; }
  int firstTriple() const { return edges_.size(); }
  int firstPatch() const { return edges_.size() + triples_.size(); }
  int firstTwist() const { return firstPatch() + 2 * patches_.size(); }
  int slots() const { return firstPatch() + 3 * patches_.size(); }
  static int capacity(const ActiveMesh& mesh);  ///< largest number of slots of any mesh

  /// Adds the sums of their slots to nodes begin..end. @pre begin is a multiple of kPack
  void add(int begin, int end, const Field& slots, Field& nodes) const;

 private:
  struct Entry {
    int role, slot;
    double coefficient;
  };

  template <class Put>
  void forEntries(const ActiveMesh& mesh, const Put& put) const;
  void listEntries(const ActiveMesh& mesh);
  void addGroup(int first_node, int nodes);
  void addColumn(const std::array<const Entry*, kPack>& entries, int real_lanes);

  Kinds kinds_;
  PackedRange edges_, triples_, patches_;
  std::vector<int> rows_;       ///< entries of node n: rows_[n] .. rows_[n + 1]
  std::vector<Entry> entries_;  ///< sorted by role for each node
  std::vector<int> groups_;     ///< columns of pack g of the nodes: groups_[g] .. groups_[g + 1]
  std::vector<GatherColumn> columns_;
  std::vector<GatherDetail> details_;
};

}  // namespace haptic_cloth

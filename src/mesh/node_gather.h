/// How what the elements do reaches the nodes: each element leaves vectors in slots of its own, each node
/// sums up the slots it is concerned with, in a fixed order. So no thread waits for another, and the bits
/// never depend on how many there are.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Numbers of the elements of one kind, warp first, each direction padded to whole packs.
struct PackedRange {
  int warp = 0, weft = 0;  ///< elements

  int warpEnd() const { return padded(warp); }
  int size() const { return padded(warp) + padded(weft); }
  /// Place of an element. @param element its index in the mesh's list, which has warp first
  int place(int element) const { return element < warp ? element : element - warp + padded(warp); }
};

/// One slot for each node of a pack. Where these follow one another and all nodes take them alike, two
/// numbers say it all; else `detail` tells which and by how much.
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
  /// Which kinds of elements do anything; the others get no entries.
  struct Kinds {
    bool bending, shear, twist;
  };

  NodeGather(const ActiveMesh& mesh, const Kinds& kinds);

  /// After a change of the mesh.
  void rebuild(const ActiveMesh& mesh);

  /// Slots: edges, triples, patches' rising sides, their falling sides, their twists.
  const PackedRange& edges() const { return edges_; }
  const PackedRange& triples() const { return triples_; }
  const PackedRange& patches() const { return patches_; }
  int firstTriple() const { return edges_.size(); }
  int firstPatch() const { return edges_.size() + triples_.size(); }
  int firstTwist() const { return firstPatch() + 2 * patches_.size(); }
  int slots() const { return firstPatch() + 3 * patches_.size(); }
  static int capacity(const ActiveMesh& mesh);  ///< most slots a mesh can need

  /// Adds to nodes begin..end what their slots hold. @pre begin is a multiple of kPack
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
  std::vector<Entry> entries_;  ///< by role for each node
  std::vector<int> groups_;     ///< columns of pack g of the nodes: groups_[g] .. groups_[g + 1]
  std::vector<GatherColumn> columns_;
  std::vector<GatherDetail> details_;
};

}  // namespace haptic_cloth

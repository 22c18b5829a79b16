#include "passes.h"

#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

constexpr double kVector = 3.0 * sizeof(double);  ///< a point or vector of one node or slot

/// Flops of a law. A linear law has 0.5 r hoisted; a table must find its interval; memory adds its
/// offsets (law_table.h).
double lawFlops(const Loop& law) {
  if (law.hasMemory()) return 11.0;
  return law.upper().intervals().size() == 1 ? 6.0 : 9.0;
}
double lawFlops(const std::array<Loop, 2>& laws) {  // warp and weft have equal numbers of elements
  return 0.5 * (lawFlops(laws[kWarp]) + lawFlops(laws[kWeft]));
}
double memoryBytes(const Loop& law) { return law.hasMemory() ? sizeof(StepPack) / kPack : 0.0; }
double memoryBytes(const std::array<Loop, 2>& laws) {
  return 0.5 * (memoryBytes(laws[kWarp]) + memoryBytes(laws[kWeft]));
}

/// Bytes per element, from the size of a pack, without `unread` arrays of one number per lane.
template <class Pack>
double packBytes(int unread) {
  return static_cast<double>(sizeof(Pack)) / kPack - unread * sizeof(double);
}

/// Numbers of elements. Padding lanes after the last element count as work.
struct Counts {
  double edges, triples, patches, nodes, unknowns, samples;
  bool shear, twist;
};

Counts countsOf(ClothCase& cloth) {
  const NodeGather& gather = cloth.internal().gather();
  return {static_cast<double>(gather.edges().size()),
          static_cast<double>(gather.triples().size()),
          static_cast<double>(gather.patches().size()),
          static_cast<double>(padded(cloth.mesh().nodes())),
          static_cast<double>(cloth.objective().size()),
          static_cast<double>(cloth.contacts().size()),
          !cloth.fabric().shear.isZero(),
          cloth.fabric().twist_rigidity > 0.0};
}

/// Adds energy and gradient, term by term; each term writes forces to slots.
void addElements(ClothCase& cloth, const Counts& n, std::vector<Pass>& passes) {
  InternalEnergy& internal = cloth.internal();
  const NodeGather& gather = internal.gather();
  const Fabric& fabric = cloth.fabric();
  const int triples = gather.firstTriple(), patches = gather.firstPatch(), end = internal.size();
  const Field& x = cloth.nodes();
  const auto range = [&internal, &x](int first, int last) {
    return [&internal, &x, first, last] {
      const InternalEnergy::Energy e = internal.evaluate(first, last, x);
      return e.stretch + e.bend + e.shear;
    };
  };
  // Flops: span 3, its length 6, its inverse 1, axis 3, strain 2, width and force 2, energy 2, slot
  // 3, stiffnesses 3.
  passes.push_back(
      {"stretch", "value", n.edges * (25.0 + lawFlops(fabric.tensile)),
       n.edges * (packBytes<EdgePack>(0) + kVector + memoryBytes(fabric.tensile)) + 2.0 * n.nodes * kVector,
       range(0, triples), n.edges});
  // Flops: curvature 20, energy 2, force 1, slot 3, stiffness 1. Reads normals and positions.
  passes.push_back({"bending", "value", n.triples * (27.0 + lawFlops(fabric.bending)),
                    n.triples * (packBytes<TriplePack>(0) + kVector + memoryBytes(fabric.bending)) +
                        (n.triples > 0.0 ? 4.0 : 0.0) * n.nodes * kVector,
                    range(triples, patches)});
  // Flops: u and v 12, their products 16, area 6, tangent 4, angle 26, its gradient 26, energy 3,
  // slots 6, stiffness 1; twist: saddle 14, stiffness 2, energy 4, slot 4.
  const double shear = n.shear ? 100.0 + lawFlops(fabric.shear) : 0.0, twist = n.twist ? 24.0 : 0.0;
  const double of_patch = packBytes<PatchPack>(0) +
                          (n.shear ? 2.0 * kVector + memoryBytes(fabric.shear) : 0.0) +
                          (n.twist ? 2.0 * kVector : 0.0);
  passes.push_back({"shear", "value", n.patches * (shear + twist),
                    n.patches * of_patch + (n.patches > 0.0 ? 1.0 : 0.0) * n.nodes * kVector,
                    range(patches, end), n.shear ? n.patches : 0.0});
  passes.push_back(
      {"contact", "value", -1.0, n.samples * (static_cast<double>(sizeof(SamplePack)) / kPack + kVector),
       [&cloth, &x] { return cloth.contacts().evaluate(0, cloth.contacts().size(), x).solids; }});
}

/// Adds the passes over nodes: inertia and gravity, and gathering the forces of the elements.
void addNodes(ClothCase& cloth, const Counts& n, std::vector<Pass>& passes) {
  const int nodes = cloth.mesh().nodes();
  // Flops: displacement 3, stiffness 1, energy 17, gradient 9. Memory: masses, three fields read,
  // one written.
  passes.push_back({"motion, gravity", "value", n.nodes * 31.0,
                    n.nodes * (2.0 * sizeof(double) + 4.0 * kVector), [&cloth, nodes] {
                      return kernels().evaluateMotion(cloth.motionTerms(), 0, nodes, cloth.nodes().arrays(),
                                                      cloth.gradient().arrays());
                    }});
  // A multiplication and an addition for each coordinate of each entry; eight entries share 16
  // bytes.
  const double entries =
      2.0 * n.edges + 3.0 * n.triples + (n.shear ? 4.0 : 0.0) * n.patches + (n.twist ? 4.0 : 0.0) * n.patches;
  const double slots = n.edges + n.triples + ((n.shear ? 2.0 : 0.0) + (n.twist ? 1.0 : 0.0)) * n.patches;
  passes.push_back({"gathering", "value", 6.0 * entries,
                    kVector * slots + 2.0 * kVector * n.nodes + 2.0 * entries, [&cloth, nodes] {
                      cloth.internal().addGradient(0, nodes, cloth.gradient());
                      return cloth.gradient().coordinate(0)[0];
                    }});
  passes.push_back(
      {"gathering of contact", "value", -1.0, kVector * n.samples + sizeof(int) * n.nodes, [&cloth, nodes] {
         cloth.contacts().addGradient(0, nodes, cloth.gradient());
         return cloth.gradient().coordinate(0)[0];
       }});
  passes.push_back({"packing", "value", 0.0, 4.0 * n.unknowns * sizeof(double), [&cloth] {
                      Proxies proxies(cloth.scene().probes.size());
                      cloth.objective().unpack(cloth.point(), cloth.gradient(), proxies);
                      cloth.objective().packFree(cloth.gradient(), cloth.scratch());
                      return cloth.scratch()[0];
                    }});
}

/// Adds the quadratic form along the direction.
void addAlong(ClothCase& cloth, const Counts& n, std::vector<Pass>& passes) {
  const InternalEnergy& internal = cloth.internal();
  const NodeGather& gather = internal.gather();
  const int triples = gather.firstTriple(), patches = gather.firstPatch(), end = internal.size();
  const Field& d = cloth.motion();
  const auto range = [&internal, &d](int first, int last) {
    return [&internal, &d, first, last] { return internal.quadraticForm(first, last, d); };
  };
  // Flops: change 3, along it 5, its square 1, all of it 5, across 1, sums 5.
  passes.push_back({"stretch, quadratic form", "along", n.edges * 20.0,
                    n.edges * packBytes<EdgePack>(2) + 2.0 * n.nodes * kVector, range(0, triples)});
  passes.push_back({"bending, quadratic form", "along", n.triples * 23.0,
                    n.triples * packBytes<TriplePack>(1) + (n.triples > 0.0 ? 4.0 : 0.0) * n.nodes * kVector,
                    range(triples, patches)});
  // Flops: sides 6, along their gradients 11, square 3; twist: saddle 14, stiffness 2, square 3.
  passes.push_back({"shear, quadratic form", "along",
                    n.patches * ((n.shear ? 20.0 : 0.0) + (n.twist ? 19.0 : 0.0)),
                    n.patches * (packBytes<PatchPack>(1) + (n.twist ? kVector : 0.0)) + n.nodes * kVector,
                    range(patches, end)});
  passes.push_back({"contact, quadratic form", "along", -1.0,
                    n.samples * static_cast<double>(sizeof(SamplePack)) / kPack, [&cloth, &d] {
                      const Proxies still(cloth.scene().probes.size());
                      return cloth.contacts().quadraticForm(0, cloth.contacts().size(), d, still, false);
                    }});
  passes.push_back(
      {"motion, quadratic form", "along", n.nodes * 7.0, n.nodes * (sizeof(double) + kVector), [&cloth] {
         return kernels().motionQuadraticForm(cloth.motionTerms(), 0, cloth.places(),
                                              cloth.motion().arrays());
       }});
  passes.push_back({"unpacking", "along", 0.0, 2.0 * n.unknowns * sizeof(double), [&cloth] {
                      Proxies proxies(cloth.scene().probes.size());
                      cloth.objective().unpack(cloth.direction(), cloth.gradient(), proxies);
                      return cloth.gradient().coordinate(0)[0];
                    }});
}

/// Adds the work that a step does once, before and after its iterations.
void addStep(ClothCase& cloth, std::vector<Pass>& passes) {
  InternalEnergy& internal = cloth.internal();
  const Field& x = cloth.nodes();
  const auto add = [&passes](const char* name, std::function<double()> run) {
    passes.push_back({name, "step", -1.0, -1.0, std::move(run)});
  };
  add("look at the mesh", [&cloth] {
    cloth.lookAtMesh();
    return 0.0;
  });
  add("normals", [&internal, &x] {
    internal.setNormals(x);
    return internal.normal(0).z();
  });
  add("contacts", [&cloth] {
    cloth.contacts().collectProbes(cloth.mesh(), cloth.nodes(), cloth.reach(), cloth.still(), {});
    cloth.contacts().collectObstacles(cloth.mesh(), cloth.nodes(), cloth.reach(), cloth.still());
    return static_cast<double>(cloth.contacts().size());
  });
  add("start of the objective", [&cloth] {
    const std::vector<ProbeStep> probes(cloth.scene().probes.size());
    cloth.objective().begin(cloth.nodes(), cloth.motion(), probes);
    return cloth.objective().inertia();
  });
  add("state at rest", [&cloth] { return cloth.objective().evaluate(cloth.point(), cloth.scratch()); });
  add("start of the solve", [&cloth] {
    const double inertial = cloth.objective().quadraticForm(cloth.direction()).sum();
    return inertial + cloth.objective().evaluate(cloth.point(), cloth.scratch());
  });
  add("fit of the preconditioner", [&cloth] {
    cloth.objective().fitPreconditioner(false);
    return cloth.scratch()[0];
  });
  add("memory of the fabric", [&internal, &x] {
    internal.commit(0, internal.size(), x);
    return 0.0;
  });
  add("energy of the fabric", [&internal, &x] { return internal.stored(x).stretch; });
  add("packs of a new mesh", [&cloth] {
    cloth.internal().resize();
    cloth.internal().setNormals(cloth.nodes());
    cloth.objective().resize();
    return 0.0;
  });
}

}  // namespace

std::vector<Pass> passesOf(ClothCase& cloth) {
  const Counts counts = countsOf(cloth);
  std::vector<Pass> passes;
  addElements(cloth, counts, passes);
  addNodes(cloth, counts, passes);
  addAlong(cloth, counts, passes);
  // Per node: its block 18 flops; as a child 12 up and 12 down; a third of a hat 8. Read and
  // written: the block 48 bytes, gradient and direction 72, values on the way up and down 96,
  // numbers, blocks and corrections of a child and a third of a hat 68.
  const double nodes = counts.unknowns / 3.0;
  passes.push_back({"preconditioner", "vectors", 50.0 * nodes, 284.0 * nodes, [&cloth] {
                      cloth.objective().precondition(cloth.direction(), cloth.scratch());
                      return cloth.scratch()[0];
                    }});
  addStep(cloth, passes);
  passes.push_back({"fit of the preconditioner", "fit", -1.0, -1.0, [&cloth] {
                      cloth.objective().fitPreconditioner(false);
                      return cloth.scratch()[0];
                    }});
  return passes;
}

// Per unknown: residual 3 (gradient, weight), two dot products 4 (three vectors), direction and
// slope 4 (three read, one written), trial point 2 (two read, one written).
double vectorFlops(int unknowns) { return 13.0 * unknowns; }
double vectorBytes(int unknowns) { return (2.0 + 3.0 + 4.0 + 3.0) * sizeof(double) * unknowns; }

}  // namespace haptic_cloth

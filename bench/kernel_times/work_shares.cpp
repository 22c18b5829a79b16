#include "work_shares.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

namespace haptic_cloth {
namespace {

constexpr int kMostThreads = 64;

/// What an item of each kind takes, as bench/kernels has measured it on one core (measured fabric, AVX-512)
/// [ns]. That is all that is not counted here.
struct Weights {
  double edge, triple, patch, sample, node;
};
constexpr Weights kGradient{4.7, 4.9, 8.3, 10.0, 6.3}, kEnergy{0.7, 1.0, 1.0, 2.3, 0.15};

/// Places of a loop in their order: the weight of each and the particle of the finest grid it lies at.
struct WorkLoop {
  std::vector<double> weights;
  std::vector<int> particles;

  void add(double weight, int particle) {
    weights.push_back(weight);
    particles.push_back(particle);
  }
};

/// Elements, then contact samples, as the objective shares them out; padding is work of the place before it.
WorkLoop elementLoop(ClothCase& cloth, const Weights& weight) {
  const ClothWorld& world = cloth.world();
  const ActiveMesh& mesh = world.mesh;
  const NodeGather& gather = world.internal.gather();
  WorkLoop loop;
  const auto put = [&](int end, double w, int first, int count, const std::function<int(int)>& node) {
    for (int k = 0; k < count; ++k) loop.add(w, mesh.particle[node(first + k)]);
    while (static_cast<int>(loop.weights.size()) < end) loop.add(w, loop.particles.back());
  };
  const auto edge = [&](int k) { return mesh.edges[k].a; };
  const auto triple = [&](int k) { return mesh.triples[k].c; };
  const auto patch = [&](int k) { return mesh.patches[k].nodes[0]; };
  const PackedRange& e = gather.edges();
  put(e.warpEnd(), weight.edge, 0, e.warp, edge);
  put(e.size(), weight.edge, e.warp, e.weft, edge);
  const PackedRange& t = gather.triples();
  put(gather.firstTriple() + t.warpEnd(), weight.triple, 0, t.warp, triple);
  put(gather.firstPatch(), weight.triple, t.warp, t.weft, triple);
  put(world.internal.size(), weight.patch, 0, gather.patches().warp, patch);
  for (int k = 0; k < world.contacts.size(); ++k) {
    loop.add(weight.sample, mesh.particle[world.contacts.firstNode(k)]);
  }
  return loop;
}

WorkLoop nodeLoop(ClothCase& cloth, double weight) {
  WorkLoop loop;
  for (const int particle : cloth.world().mesh.particle) loop.add(weight, particle);
  return loop;
}

/// How work falls to threads.
enum class Sharing {
  Turns,  ///< as the library has it: blocks of fixed size in turns (OpenMP's static, 1)
  Rows,   ///< each thread a row of the same blocks (static): what that would give
  Grid    ///< each thread as many particles of the finest grid, active or not
};

double mostOfBlocks(const WorkLoop& loop, int threads, bool in_turns) {
  const int count = static_cast<int>(loop.weights.size()), blocks = (count + Team::kBlock - 1) / Team::kBlock;
  std::vector<double> work(threads, 0.0);
  // The first threads have one block more where they do not come out even.
  const int each = blocks / threads, more = blocks % threads, larger = more * (each + 1);
  for (int k = 0; k < count; ++k) {
    const int block = k / Team::kBlock;
    const int in_row = block < larger ? block / (each + 1) : more + (block - larger) / std::max(1, each);
    work[in_turns ? block % threads : in_row] += loop.weights[k];
  }
  return *std::max_element(work.begin(), work.end());
}

/// The same where each thread has as many particles of the finest grid.
double mostOfGrid(const WorkLoop& loop, int threads, int particles) {
  std::vector<double> work(threads, 0.0);
  for (std::size_t k = 0; k < loop.weights.size(); ++k) {
    const auto thread = static_cast<long long>(loop.particles[k]) * threads / particles;
    work[static_cast<std::size_t>(thread)] += loop.weights[k];
  }
  return *std::max_element(work.begin(), work.end());
}

double sumOf(const WorkLoop& loop) {
  double sum = 0.0;
  for (const double weight : loop.weights) sum += weight;
  return sum;
}

/// A pass is one or several loops, and threads meet after each.
struct Shares {
  double most = 0.0, all = 0.0;
  void add(double most_of_loop, double all_of_loop) {
    most += most_of_loop;
    all += all_of_loop;
  }
  double percent(int threads) const { return 100.0 * (most * threads / all - 1.0); }
};

/// Evaluating, looking along, and both, as an iteration needs them.
using Passes = std::array<std::vector<WorkLoop>, 2>;

nlohmann::json rowOf(ClothCase& cloth, const Passes& passes, int threads, Sharing sharing) {
  const int particles = cloth.world().mesh.grid.particles();
  std::array<Shares, 3> shares;
  for (int pass = 0; pass < 2; ++pass) {
    for (const WorkLoop& loop : passes[pass]) {
      const double most = sharing == Sharing::Grid ? mostOfGrid(loop, threads, particles)
                                                   : mostOfBlocks(loop, threads, sharing == Sharing::Turns);
      shares[pass].add(most, sumOf(loop));
      shares[2].add(most, sumOf(loop));
    }
  }
  constexpr const char* names[] = {"active lists", "active lists, in rows", "finest grid"};
  nlohmann::json row;
  row["strategy"] = cloth.options().strategy;
  row["fabric"] = cloth.options().fabric;
  row["shared"] = names[static_cast<int>(sharing)];
  row["threads"] = threads;
  row["particles"] = cloth.particles();
  row["gradient_percent"] = shares[0].percent(threads);
  row["energy_percent"] = shares[1].percent(threads);
  row["imbalance_percent"] = shares[2].percent(threads);
  return row;
}

}  // namespace

std::string workSharesJson(const std::vector<std::unique_ptr<ClothCase>>& cases) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& cloth : cases) {
    const Passes passes{{{elementLoop(*cloth, kGradient), nodeLoop(*cloth, kGradient.node)},
                         {elementLoop(*cloth, kEnergy), nodeLoop(*cloth, kEnergy.node)}}};
    for (const Sharing sharing : {Sharing::Turns, Sharing::Rows, Sharing::Grid}) {
      for (int threads = 1; threads <= kMostThreads; ++threads) {
        rows.push_back(rowOf(*cloth, passes, threads, sharing));
      }
    }
  }
  return rows.dump(1);
}

}  // namespace haptic_cloth

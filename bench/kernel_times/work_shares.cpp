#include "work_shares.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

namespace haptic_cloth {
namespace {

constexpr int kMostThreads = 64;

/// Time per item of each kind, measured by bench/kernels on one core (measured fabric, AVX-512)
/// [ns]. Everything else here is counted.
struct Weights {
  double edge, triple, patch, sample, node;
};
constexpr Weights kGradient{4.7, 4.9, 8.3, 10.0, 6.3}, kEnergy{0.7, 1.0, 1.0, 2.3, 0.15};

/// Items of a loop in order: the weight of each and its particle of the finest grid.
struct WorkLoop {
  std::vector<double> weights;
  std::vector<int> particles;

  void add(double weight, int particle) {
    weights.push_back(weight);
    particles.push_back(particle);
  }
};

/// Elements, then contact samples, in the order in which the objective runs them. Padding has the
/// weight of the item before it.
WorkLoop elementLoop(ClothCase& cloth, const Weights& weight) {
  const ActiveMesh& mesh = cloth.mesh();
  const NodeGather& gather = cloth.internal().gather();
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
  put(cloth.internal().size(), weight.patch, 0, gather.patches().warp, patch);
  for (int k = 0; k < cloth.contacts().size(); ++k) {
    loop.add(weight.sample, mesh.particle[cloth.contacts().firstNode(k)]);
  }
  return loop;
}

WorkLoop nodeLoop(ClothCase& cloth, double weight) {
  WorkLoop loop;
  for (const int particle : cloth.mesh().particle) loop.add(weight, particle);
  return loop;
}

/// Ways to divide work among threads.
enum class Sharing {
  Helping,  ///< the library's way: each thread has a row of blocks and then helps the others
  Rows,     ///< the same without help
  Grid      ///< each thread has equally many particles of the finest grid, active or not
};

/// Work of the busiest thread. The thread that finishes first takes the next block.
double mostOfBlocks(const WorkLoop& loop, int threads, bool helping) {
  const int count = static_cast<int>(loop.weights.size()), blocks = (count + Team::kBlock - 1) / Team::kBlock;
  std::vector<double> of_block(blocks, 0.0), work(threads, 0.0);
  for (int k = 0; k < count; ++k) of_block[k / Team::kBlock] += loop.weights[k];
  std::vector<int> next(threads), end(threads);
  for (int t = 0; t < threads; ++t) {
    next[t] = blocks * t / threads;
    end[t] = blocks * (t + 1) / threads;
  }
  for (int taken = 0; taken < blocks; ++taken) {
    int thread = -1, from = -1;
    for (int t = 0; t < threads; ++t) {
      int part = t;
      while (helping && next[part] == end[part]) part = (part + 1) % threads;
      if (next[part] == end[part] || (thread >= 0 && work[t] >= work[thread])) continue;
      thread = t;
      from = part;
    }
    work[thread] += of_block[next[from]++];
  }
  return *std::max_element(work.begin(), work.end());
}

/// Work of the busiest thread if each has equally many particles of the finest grid.
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

/// Sums over the loops of a pass. Threads meet after each loop.
struct Shares {
  double most = 0.0, all = 0.0;
  void add(double most_of_loop, double all_of_loop) {
    most += most_of_loop;
    all += all_of_loop;
  }
  double percent(int threads) const { return 100.0 * (most * threads / all - 1.0); }
};

/// The two passes of an iteration: evaluation, and the quadratic form along the direction.
using Passes = std::array<std::vector<WorkLoop>, 2>;

nlohmann::json rowOf(ClothCase& cloth, const Passes& passes, int threads, Sharing sharing) {
  const int particles = cloth.mesh().grid.particles();
  std::array<Shares, 3> shares;
  for (int pass = 0; pass < 2; ++pass) {
    for (const WorkLoop& loop : passes[pass]) {
      const double most = sharing == Sharing::Grid ? mostOfGrid(loop, threads, particles)
                                                   : mostOfBlocks(loop, threads, sharing == Sharing::Helping);
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
    for (const Sharing sharing : {Sharing::Helping, Sharing::Rows, Sharing::Grid}) {
      for (int threads = 1; threads <= kMostThreads; ++threads) {
        rows.push_back(rowOf(*cloth, passes, threads, sharing));
      }
    }
  }
  return rows.dump(1);
}

}  // namespace haptic_cloth

/// kernel_times: passes of an iteration under Google Benchmark. bench/kernels and bench/threads run
/// it.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cloth_case.h"
#include "haptic_cloth/machine.h"
#include "limits.h"
#include "openmp_costs.h"
#include "passes.h"
#include "plain_gradient.h"
#include "work_shares.h"

namespace {

using namespace haptic_cloth;

constexpr const char* kUsage =
    "kernel_times [--strategy=a,b] [--fabric=a,b] [--side=N] [--time=S] [--limits] [--threads=1,2] "
    "[--shares]\n"
    "             [--machine]\n"
    "  and the options of Google Benchmark. Names: limits/..., MESH/FABRIC/PASS, threads/N/MESH/PASS,\n"
    "  openmp/N/PASS. Counters: flops and bytes of one run, particles, unknowns, evaluations an iteration.\n"
    "  --shares: prints the work of each thread for 1 to 64 of them as JSON, and measures nothing.\n"
    "  --machine: prints processor and instruction set as JSON, and measures nothing.";

/// Roughly the iterations of a step.
constexpr int kIterations = 60;

constexpr int kRounds = 1000;  ///< multiply-adds in a run

/// Evaluations, regions, loops or barriers in a run; TIMES in bench/thread_parts.py.
constexpr int kTimes = 100;

struct Options {
  std::vector<std::string> strategies{"finest", "amrc"}, fabrics{"linear", "winter_suiting"};
  std::vector<int> threads;
  int side = 77;
  double time = 0.2;
  bool limits = false, shares = false, machine = false;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

/// Reads the program's own options and leaves the others. @return false for --help
bool parse(int& argc, char** argv, Options& options) {
  int left = 1;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    const auto equals = argument.find('=');
    const std::string key = argument.substr(0, equals),
                      value = equals == std::string::npos ? "" : argument.substr(equals + 1);
    if (key == "--help") return false;
    if (key == "--strategy") {
      options.strategies = split(value);
    } else if (key == "--fabric") {
      options.fabrics = split(value);
    } else if (key == "--side") {
      options.side = std::atoi(value.c_str());
    } else if (key == "--time") {
      options.time = std::atof(value.c_str());
    } else if (key == "--threads") {
      for (const std::string& word : split(value)) options.threads.push_back(std::atoi(word.c_str()));
    } else if (key == "--limits") {
      options.limits = true;
    } else if (key == "--machine") {
      options.machine = true;
    } else if (key == "--shares") {
      options.shares = true;
    } else {
      argv[left++] = argv[k];
    }
  }
  argc = left;
  return true;
}

template <class Work>
void addSimple(const std::string& name, double flops, double bytes, const Work& work, double particles = 0.0,
               double roots = 0.0) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(work());
    state.counters["flops"] = flops;
    state.counters["bytes"] = bytes;
    state.counters["roots"] = roots;
    state.counters["particles"] = particles;
    state.SetLabel(instructionSet());
  });
}

/// Adds the time of plain loops for a gradient on the same grid.
void addPlainGradient(int side) {
  const auto sheet = std::make_shared<PlainSheet>(side);
  addSimple(
      "limits/plain gradient", 0.0, 0.0, [sheet] { return sheet->gradient(); }, sheet->particles());
}

void addLimits() {
  const auto chains = [&](int count, double (*loop)(int)) {
    addSimple("limits/fma/" + std::to_string(count), 2.0 * kRounds * count, 0.0,
              [loop] { return loop(kRounds); });
  };
  chains(24, multiplyAdd24);
  chains(48, multiplyAdd48);
  chains(96, multiplyAdd96);
  const std::vector<double> values(2048, 2.0);  // small enough for the nearest cache
  const int count = static_cast<int>(values.size());
  addSimple(
      "limits/roots", 0.0, 0.0, [values, count] { return rootAndDivide(values.data(), count); }, 0.0, count);
  for (std::size_t size = 16 << 10; size <= std::size_t{64} << 20; size *= 2) {
    const auto triad = std::make_shared<Triad>(size);
    addSimple("limits/triad/" + std::to_string(size), 0.0, triad->bytes(), [triad] {
      triad->run();
      benchmark::ClobberMemory();
      return triad->last();
    });
  }
}

/// Adds whole iterations or the minimizer's part of them; the time is that of one.
template <class Iterate>
void addIterations(const std::string& name, ClothCase& cloth, double flops, double bytes,
                   const Iterate& iterate) {
  const auto measure = [&cloth, flops, bytes, iterate](benchmark::State& state) {
    double evaluations = 0.0;
    for (auto _ : state) {
      const ClothCase::Iterations done = iterate(kIterations);
      if (done.iterations == 0) {
        state.SkipWithError("no iteration was possible");
        return;
      }
      // Alone on its core a thread has all of the time. With several threads the slowest counts, so
      // wall time.
      const double seconds = cloth.threads() == 1 ? done.cpu_seconds : done.seconds;
      state.SetIterationTime(seconds / done.iterations);
      evaluations = static_cast<double>(done.evaluations) / done.iterations;
    }
    state.counters["evaluations"] = evaluations;
    state.counters["flops"] = flops;
    state.counters["bytes"] = bytes;
    state.counters["particles"] = cloth.particles();
    state.SetLabel(instructionSet());
  };
  benchmark::RegisterBenchmark(name.c_str(), measure)->UseManualTime()->Iterations(3);
}

void addPasses(const std::string& name, ClothCase& cloth) {
  for (const Pass& pass : passesOf(cloth)) {
    addSimple(name + pass.part + "/" + pass.name, pass.flops, pass.bytes, pass.run, cloth.particles(),
              pass.roots);
  }
  const int unknowns = cloth.objective().size();
  addIterations(name + "vectors/vector updates", cloth, vectorFlops(unknowns), vectorBytes(unknowns),
                [&cloth](int count) { return cloth.iterateVectors(count); });
  addIterations(name + "whole/iteration", cloth, -1.0, -1.0,
                [&cloth](int count) { return cloth.iterate(count); });
}

/// Adds the parts of Table 2 of [M04] for a number of threads. A run of the first two has kTimes evaluations.
void addThreads(int threads, const std::string& strategy, ClothCase& cloth) {
  const std::string name = "threads/" + std::to_string(threads) + "/" + strategy + "/";
  const auto on_threads = [&cloth, threads] {
    if (cloth.threads() != threads) cloth.setThreads(threads);
  };
  const auto add = [&](const char* what, const auto& work) {
    const auto run = [&cloth, on_threads, work] {
      on_threads();
      return cloth.inRegion(kTimes, work);
    };
    addSimple(name + what, -1.0, -1.0, run, cloth.particles());
  };
  add("gradient", [&cloth] { return cloth.objective().evaluate(cloth.point(), cloth.scratch()); });
  add("energy", [&cloth] { return cloth.objective().along(cloth.direction(), -1.0).quadratic_form; });
  addIterations(name + "total", cloth, -1.0, -1.0, [&cloth, on_threads](int count) {
    on_threads();
    return cloth.iterate(count);
  });
}

void addOpenMp(int threads) {
  const std::string name = "openmp/" + std::to_string(threads) + "/";
  const auto add = [&](const char* what, void (*work)(int, int)) {
    addSimple(name + what, -1.0, -1.0, [work, threads] {
      work(threads, kTimes);
      return 0;
    });
  };
  addSimple(name + "delay", -1.0, -1.0, [] {
    for (int k = 0; k < kTimes; ++k) delay();
    return 0;
  });
  add("fork", forkAndJoin);
  add("loop", shareLoops);
  add("barrier", meetAtBarriers);
}

std::vector<std::unique_ptr<ClothCase>> makeCases(const Options& options) {
  std::vector<std::unique_ptr<ClothCase>> cases;
  for (const std::string& strategy : options.strategies) {
    for (const std::string& fabric : options.fabrics) {
      cases.push_back(
          std::make_unique<ClothCase>(CaseOptions{strategy, fabric, options.side, options.time, 1}));
    }
  }
  return cases;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::cout << kUsage << std::endl;
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    if (options.machine) {
      std::cout << nlohmann::json{{"processor", processorName()}, {"simd", instructionSet()}} << std::endl;
      return 0;
    }
    const auto cases = makeCases(options);
    if (options.shares) {
      std::cout << workSharesJson(cases) << std::endl;
      return 0;
    }
    if (options.limits) {
      addPlainGradient(options.side);
      addLimits();
    }
    for (const auto& cloth : cases) {
      const CaseOptions& made = cloth->options();
      if (options.threads.empty()) addPasses(made.strategy + "/" + made.fabric + "/", *cloth);
      for (const int threads : options.threads) addThreads(threads, made.strategy, *cloth);
    }
    for (const int threads : options.threads) addOpenMp(threads);
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << "kernel_times: " << error.what() << std::endl;
    return 2;
  }
  return 0;
}

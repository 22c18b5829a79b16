/// Continuation of a saved run. Criterion: it equals the uninterrupted run, in all bits of
/// everything that can be queried after every step, and of the final state.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "haptic_cloth/error.h"
#include "support/state_cases.h"

namespace haptic_cloth::continuation_test {
namespace {

/// Number of steps after loading: longer than any counter (age of cells, steps to sleep).
constexpr int kGoesOn = 60;

int endOf(const StateCase& run, int from) { return std::min(from + kGoesOn, run.steps); }

/// Uninterrupted run of a case, with the events that it exercised.
struct Reference {
  explicit Reference(const StateCase& run) {
    Simulation simulation(run.scene);
    for (int step = 0;; ++step) {
      const bool wanted = std::any_of(run.saves.begin(), run.saves.end(),
                                      [&](int from) { return step == from || step == endOf(run, from); });
      if (wanted) saved[step] = simulation.saveState();
      at_rest.push_back(readings(simulation));
      if (step == run.steps) break;
      after.push_back(advance(run, simulation, step, &exercised));
    }
  }
  Exercised exercised;
  /// Readings before each step; readings with its report after it.
  std::vector<std::uint64_t> at_rest, after;
  std::map<int, std::string> saved;
};

/// Compares a loaded run with the reference.
/// @return first step that differs; the last step if none does
int firstDifference(const StateCase& run, const Reference& reference, Simulation& loaded, int from) {
  if (readings(loaded) != reference.at_rest[from]) return from;
  for (int step = from; step < endOf(run, from); ++step) {
    if (advance(run, loaded, step) != reference.after[step]) return step;
  }
  return endOf(run, from);
}

TEST(Continuation, IsTheSameRunToTheLastBit) {
  for (StateCase run : stateCases()) {
    SCOPED_TRACE(run.name);
    const Reference reference(run);
    EXPECT_TRUE(run.exercises(reference.exercised)) << "the case does not do what it is there for";
    for (const int from : run.saves) {
      SCOPED_TRACE("saved after " + std::to_string(from) + " steps");
      run.scene.solver.threads = 1 + from % 3;  // the number of threads must not matter
      Simulation loaded(run.scene);
      loaded.loadState(reference.saved.at(from), "state");
      EXPECT_TRUE(loaded.saveState() == reference.saved.at(from));
      EXPECT_EQ(firstDifference(run, reference, loaded, from), endOf(run, from));
      EXPECT_TRUE(loaded.saveState() == reference.saved.at(endOf(run, from)));
    }
  }
}

/// Value that an entry would have had without being loaded: that of a new simulation, or zeros if
/// its length differs.
std::string forgotten(const StateEntry& entry, const std::map<std::string, std::string>& fresh) {
  const auto value = fresh.find(entry.name);
  const bool fits = value != fresh.end() && value->second.size() == entry.bytes.size();
  return fits ? value->second : std::string(entry.bytes.size(), '\0');
}

/// Removes numbers: "probe[1].present" becomes "probe.present". An entry that one probe needs, all
/// need.
std::string withoutNumbers(const std::string& name) {
  return std::regex_replace(name, std::regex("\\[[0-9]+\\]"), "");
}

/// @return whether the case continues differently, or is refused, if entry k has other bytes
bool makesADifference(const StateCase& run, const Reference& reference, int from,
                      std::vector<StateEntry> entries, std::size_t k, const std::string& bytes) {
  entries[k].bytes = bytes;
  Simulation loaded(run.scene);
  try {
    loaded.loadState(sealState(entries), "state");
  } catch (const InputError&) {
    return true;
  }
  const int end = endOf(run, from);
  return firstDifference(run, reference, loaded, from) < end || loaded.saveState() != reference.saved.at(end);
}

/// Every entry must matter. A forgotten member would keep the value of a new simulation, so each
/// entry in turn is set to that value. Some case must then continue or end differently; otherwise
/// no test would notice that the member is missing. (Skipped steps have the same readings as steps
/// in which all sleep; only their count differs.)
TEST(Continuation, WouldDifferWithoutAnyOfItsEntries) {
  std::set<std::string> all, needed;
  for (const StateCase& run : stateCases()) {
    const Reference reference(run);
    std::map<std::string, std::string> fresh;
    for (const StateEntry& entry : stateEntries(Simulation(run.scene).saveState()))
      fresh[entry.name] = entry.bytes;
    for (const int from : run.saves) {
      const std::vector<StateEntry> entries = stateEntries(reference.saved.at(from));
      const auto first = std::find_if(entries.begin(), entries.end(),
                                      [](const StateEntry& entry) { return entry.name == "steps"; });
      for (std::size_t k = first - entries.begin(); k < entries.size();
           ++k) {  // earlier entries belong to the scene
        const std::string name = withoutNumbers(entries[k].name);
        all.insert(name);
        const std::string other = forgotten(entries[k], fresh);
        if (needed.count(name) > 0 || other == entries[k].bytes) continue;
        if (makesADifference(run, reference, from, entries, k, other)) needed.insert(name);
      }
    }
  }
  // No case begins inside an obstacle; let_out is tested in entry_test.cpp.
  needed.insert({"ejection_work", "contacts.let_out", "contacts.let_out_particle"});
  // No case rests folded; idle_tracker_test.cpp tests these.
  needed.insert({"idle.self_contacts", "idle.min_self_gap"});
  // No case is sure to split a cell that sticks in the step after a save.
  needed.insert({"contacts.half", "contacts.layers.half"});
  EXPECT_GT(all.size(), 40u);
  for (const std::string& name : all) {
    EXPECT_EQ(needed.count(name), 1u) << name << " makes no difference in any case";
  }
}

}  // namespace
}  // namespace haptic_cloth::continuation_test

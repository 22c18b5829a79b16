/// Invalid states are refused with a message that names the reason, and leave the simulation
/// unchanged; files are written completely or not at all. Criterion: docs/reference/states.md.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "haptic_cloth/error.h"
#include "haptic_cloth/state_file.h"
#include "support/scenes.h"
#include "support/state_cases.h"

namespace haptic_cloth::state_test {
namespace {

namespace fs = std::filesystem;

/// Drape after some steps, whose mesh is coarse in places.
StateCase drape() {
  StateCase run = stateCases()[0];
  run.steps = 50;
  return run;
}

class State : public testing::Test {
 protected:
  State() : run_(drape()), simulation_(run_.scene) {
    for (int step = 0; step < run_.steps; ++step) advance(run_, simulation_, step);
    saved_ = simulation_.saveState();
  }

  /// Expects a refusal with a message that contains every word; the simulation continues as if
  /// nothing had happened.
  void expectRefused(const std::string& state, const std::vector<std::string>& words) {
    expectRefused(state, run_.scene, words);
  }
  void expectRefused(const std::string& state, const Scene& scene, const std::vector<std::string>& words) {
    Simulation other(scene);
    other.step();
    const std::uint64_t before = readings(other);
    std::string message = "accepted";
    try {
      other.loadState(state, "drape.state");
    } catch (const InputError& error) {
      message = error.what();
    }
    for (const std::string& word : words) {
      EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.find("drape.state: "), 0u) << message;
    EXPECT_EQ(readings(other), before);
    other.step();
  }

  /// Saved state with one changed entry, otherwise valid.
  template <class Change>
  std::string changed(const std::string& name, const Change& change) const {
    std::vector<StateEntry> entries = stateEntries(saved_);
    bool found = false;
    for (StateEntry& entry : entries) {
      if (entry.name != name) continue;
      change(entry);
      found = true;
    }
    EXPECT_TRUE(found) << name;
    return sealState(entries);
  }

  StateCase run_;
  Simulation simulation_;
  std::string saved_;
};

template <class T>
void set(StateEntry& entry, std::size_t index, T value) {
  std::memcpy(&entry.bytes[index * sizeof(T)], &value, sizeof(T));
}

TEST_F(State, EntriesAreAsDocumented) {
  EXPECT_EQ(sealState(stateEntries(saved_)), saved_);
  Simulation other(run_.scene);
  EXPECT_NO_THROW(other.loadState(sealState(stateEntries(saved_)), "state"));
}

TEST_F(State, WhatIsCutOffOrDamagedIsRefused) {
  expectRefused("", {"does not begin"});
  expectRefused("cloth: {fabric: linear}\n", {"does not begin"});
  for (const double share : {0.0001, 0.01, 0.5, 0.999}) {
    const auto size = static_cast<std::size_t>(share * saved_.size());
    expectRefused(saved_.substr(0, size), {size < 19 ? "does not begin" : "cut off"});
  }
  expectRefused(saved_.substr(0, saved_.size() - 1), {"cut off"});
  expectRefused(saved_ + "x", {"has grown"});
  // Changes one bit: in the name of an entry, in its values, at the end.
  for (const std::size_t at : {std::size_t{60}, saved_.size() / 3, saved_.size() / 2, saved_.size() - 1}) {
    std::string damaged = saved_;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    expectRefused(damaged, {"damaged", "checksum"});
  }
}

TEST_F(State, OtherVersionsAndMachinesAreRefused) {
  std::string other = saved_;
  other[23] = 1;  // offset of the version, after magic and byte order
  expectRefused(other, {"version = 1", "must be 17"});
  other = saved_;
  std::reverse(other.begin() + 19, other.begin() + 23);
  expectRefused(other, {"byte order"});
}

TEST_F(State, AnotherSceneIsRefusedByTheKeyThatDiffers) {
  const auto with = [this](const auto& change) {
    Scene scene = run_.scene;
    change(scene);
    return scene;
  };
  const auto refused = [&](const std::vector<std::string>& words, const auto& change) {
    expectRefused(saved_, with(change), words);
  };
  refused({"cloth.particles[1] = 17", "here has 33"}, [](Scene& s) { s.cloth.particles[1] = 33; });
  refused({"cloth.size = [0.08, 0.08]", "[0.08, 0.09]"}, [](Scene& s) { s.cloth.size[1] = 0.09; });
  refused({"cloth.position"}, [](Scene& s) { s.cloth.pose.position.x() += 0.01; });
  refused({"cloth.pins", "4", "5"}, [](Scene& s) { s.cloth.pins.push_back(s.cloth.pins[0]); });
  refused({"cloth.fabric = winter_suiting", "has linen"}, [](Scene& s) { s.cloth.fabric.name = "linen"; });
  refused({"cloth.fabric.tensile.weft"},
          [](Scene& s) { s.cloth.fabric.tensile[kWeft] = Curve::linear(500.0); });
  refused({"cloth.fabric.areal_density"}, [](Scene& s) { s.cloth.fabric.areal_density *= 1.1; });
  refused({"cloth.self_contact = 1", "0"}, [](Scene& s) { s.cloth.self_contact = false; });
  refused({"cloth.self_friction = 0.3", "0.4"}, [](Scene& s) { s.cloth.self_friction = 0.4; });
  refused({"gravity = [0, 0, -9.81]", "[0, 0, -1.62]"}, [](Scene& s) { s.gravity.z() = -1.62; });
  refused({"obstacles", "0", "1"}, [](Scene& s) { s.obstacles.emplace_back(); });
  refused({"probes.probe.friction = 0.4", "0.5"}, [](Scene& s) { s.probes[0].friction = 0.5; });
  refused({"probes[0] = probe", "index"}, [](Scene& s) { s.probes[0].name = "index"; });
  refused({"solver.cost = condensed", "joint"}, [](Scene& s) { s.solver.cost = Cost::Joint; });
  refused({"solver.tolerance = 0.1", "0.2"}, [](Scene& s) { s.solver.minimizer.tolerance = 0.2; });
  refused({"solver.time_step = 0.001", "0.002"}, [](Scene& s) { s.solver.time_step = 0.002; });
  refused({"probes.probe.coupling_stiffness = 400:", "has 400.00000000000006"},
          [](Scene& s) { s.probes[0].coupling_stiffness = std::nextafter(400.0, 500.0); });
  refused({"adapt.strategy = amrc", "finest"}, [](Scene& s) { s.adapt.strategy = Strategy::Finest; });
  refused({"adapt.levels = 2", "1"}, [](Scene& s) { s.adapt.levels = 1; });
  refused({"adapt.start = finest", "coarsest"}, [](Scene& s) { s.adapt.start = StartMesh::Coarsest; });
}

TEST_F(State, WhatARunIsToldFromOutsideMayDiffer) {
  Scene scene = run_.scene;
  scene.stop.time = 77.0;
  scene.solver.threads = 2;
  scene.solver.minimizer.time_budget = 1.0;
  scene.probes[0].path = {{0.0, Vec3::Zero()}};
  scene.probes[0].grasp = {{0.0, 1.0}};
  Simulation other(scene);
  EXPECT_NO_THROW(other.loadState(saved_, "state"));
  EXPECT_EQ(other.saveState(), saved_);
}

/// The same state is accepted where the cloth may pass through itself.
TEST_F(State, ClothThatPassesThroughItselfIsRefusedByThePlace) {
  std::vector<StateEntry> entries = stateEntries(saved_);
  foldThrough(entries, run_.scene.cloth.size[0], 0.01);
  expectRefused(sealState(entries), {"cloth = ", " crossings, first of cells (", ") at [",
                                     "must not pass through itself", "cannot untangle"});

  const auto self_contact = std::find_if(entries.begin(), entries.end(), [](const StateEntry& entry) {
    return entry.name == "cloth.self_contact";
  });
  ASSERT_NE(self_contact, entries.end());
  self_contact->bytes[0] = 0;
  Scene passing = run_.scene;
  passing.cloth.self_contact = false;
  Simulation other(passing);
  EXPECT_NO_THROW(other.loadState(sealState(entries), "state"));
  EXPECT_GT(other.crossings().pairs, 0);
}

TEST_F(State, ImpossibleValuesAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  expectRefused(changed("particles.position", [&](StateEntry& e) { set(e, 7, nan); }),
                {"particles.position", "finite"});
  expectRefused(changed("fabric.edges.memory", [&](StateEntry& e) { set(e, 0, infinite); }),
                {"fabric.edges.memory", "finite"});
  expectRefused(changed("steps", [](StateEntry& e) { set(e, 0, -1L); }), {"steps", "from 0"});
  expectRefused(changed("born", [](StateEntry& e) { set(e, 3, 1000000L); }), {"born", "to 50"});
  expectRefused(changed("leaves.levels", [](StateEntry& e) { e.bytes[0] = 9; }),
                {"leaves.levels", "from 0 to 2"});
  // Each level is valid, but the mesh is not: a cell of level 1 has three siblings.
  expectRefused(changed("leaves.levels",
                        [](StateEntry& e) { e.bytes[0] = static_cast<char>(e.bytes[0] == 1 ? 0 : 1); }),
                {"leaves.levels", "balanced"});
  expectRefused(changed("rest.still", [](StateEntry& e) { set(e, 0, -5); }), {"rest.still"});
  expectRefused(changed("probe[0].present", [](StateEntry& e) { e.bytes[0] = 7; }),
                {"probe[0].present", "from 0 to 1"});
  expectRefused(changed("probe[0].device_orientation", [](StateEntry& e) { set(e, 3, 5.0); }), {"norm 1"});
  expectRefused(changed("touched[0].count", [](StateEntry& e) { set(e, 0, 1L << 60); }),
                {"touched[0].count", "from 0"});
  // Possible for the cloth, but of a state that is larger: nothing of that size is allocated.
  expectRefused(changed("contacts.samples", [](StateEntry& e) { set(e, 0, 15000L); }),
                {"contacts.samples", "what follows"});
  expectRefused(changed("held_count", [](StateEntry& e) { set(e, 0, 3L); }),
                {"held_particles", "0 values, not 3"});
  expectRefused(changed("velocities.y", [](StateEntry& e) { e.bytes.resize(8); }),
                {"velocities.y", "1 values"});
  expectRefused(changed("velocities.y", [](StateEntry& e) { e.type = 'l'; }), {"velocities.y", "type"});
  expectRefused(changed("velocities.y", [](StateEntry& e) { e.name = "speeds"; }),
                {"velocities.y", "'speeds'"});
  std::vector<StateEntry> entries = stateEntries(saved_);
  entries.push_back(entries.back());
  expectRefused(sealState(entries), {"more entries"});
  entries.resize(entries.size() - 2);
  expectRefused(sealState(entries), {"support_force", "missing"});
}

/// Steps at rest count on after a state whose counters are as large as a state may have them: the next
/// state can be loaded as well. A counter that grew with each step would come there after days.
/// Cloth of few particles under a thin capsule has many samples for each of them.
TEST(ThinProbe, LeavesAStateThatCanBeLoaded) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 3, 3, 0.3, 0.3);
  pin(scene, 0, 0, 0, 2);
  pin(scene, 2, 2, 0, 2);
  scene.probes[0].radius = 0.008;
  scene.probes[0].length = 0.3;
  Simulation simulation(scene), other(scene);
  DeviceState device;
  device.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  for (int step = 0; step < 300; ++step) {
    device.position.z() = 0.018 - 1e-4 * step;
    simulation.setDevice(0, device);
    simulation.step();
  }
  ASSERT_TRUE(simulation.probe().contact);
  other.loadState(simulation.saveState(), "state");
  EXPECT_EQ(other.stateHash(), simulation.stateHash());
}

TEST(LongRest, LeavesAStateThatCanBeLoaded) {
  constexpr int kLargest = std::numeric_limits<int>::max();
  LinearFabric linear;
  Scene scene = sheetScene(makeFabric(linear), 9, 9, 0.08, 0.08);
  pinAllSides(scene);
  scene.gravity.setZero();
  scene.solver.sleep_speed = 0.1;
  // Closed on nothing, so all sleep and no step is skipped; or in the cloth, whose particles move slowly.
  for (const double height : {0.1, 0.001}) {
    Simulation simulation(scene);
    const auto step = [height](Simulation& steps, int count) {
      for (int k = 0; k < count; ++k) {
        steps.setDevice(0, {Vec3(0.0, 0.0, height), Vec3::Zero()});
        steps.setGrasp(0, true);
        steps.step();
      }
    };
    simulation.setDevice(0, {Vec3(0.0, 0.0, 0.1), Vec3::Zero()});
    step(simulation, 200);
    std::vector<StateEntry> entries = stateEntries(simulation.saveState());
    int changed = 0;
    for (StateEntry& entry : entries) {
      if (entry.name == "idle.quiet") {
        set(entry, 0, kLargest / 2);
        ++changed;
      } else if (entry.name == "rest.still") {
        for (std::size_t k = 0; k < entry.bytes.size() / sizeof(int); ++k) set(entry, k, kLargest);
        ++changed;
      }
    }
    EXPECT_EQ(changed, 2);
    Simulation old(scene), later(scene);
    old.loadState(sealState(entries), "old");
    step(old, 3);
    EXPECT_NO_THROW(later.loadState(old.saveState(), "later")) << height;
  }
}

class StateFile : public State {
 protected:
  StateFile() : folder_(fs::temp_directory_path() / ("haptic_cloth_state_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~StateFile() override { fs::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  static void write(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  /// Number of files in the folder; nothing may be left behind.
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  template <class Error>
  static std::string message(const std::string& file, const std::string& state) {
    try {
      writeStateFile(file, state);
    } catch (const Error& error) {
      return error.what();
    }
    return "written";
  }

  fs::path folder_;
};

TEST_F(StateFile, HoldsWhatWasWritten) {
  writeStateFile(file("one"), saved_);
  EXPECT_EQ(readStateFile(file("one")), saved_);
  const std::string later = Simulation(run_.scene).saveState();
  writeStateFile(file("one"), later);  // a state may be replaced
  EXPECT_EQ(readStateFile(file("one")), later);
  fs::create_symlink("one", file("link"));
  writeStateFile(file("link"), later);
  EXPECT_TRUE(fs::is_symlink(file("link")));
  EXPECT_EQ(readStateFile(file("one")), later);
  EXPECT_EQ(files(), 2u);
}

TEST_F(StateFile, IsNotWrittenOfAnythingElse) {
  EXPECT_NE(message<InputError>(file("one"), "hello").find("state: must be a state"), std::string::npos);
  EXPECT_NE(message<InputError>(file("one"), saved_.substr(0, 100)).find("cut off"), std::string::npos);
  EXPECT_EQ(files(), 0u);
}

TEST_F(StateFile, AFileOfTheUsersIsNotTakenForATemporaryOne) {
  write(file("one.partial"), "the user's");
  writeStateFile(file("one"), saved_);
  EXPECT_EQ(readStateFile(file("one")), saved_);
  std::ostringstream kept;
  kept << std::ifstream(file("one.partial")).rdbuf();
  EXPECT_EQ(kept.str(), "the user's");
  EXPECT_EQ(files(), 2u);
}

TEST_F(StateFile, OldContentSurvivesAFullDisk) {
  writeStateFile(file("old"), saved_);
  const std::string later = Simulation(run_.scene).saveState();
  // The system limits files of this process to half of the state. As on a full disk, the first
  // bytes are written, then no more.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto on_signal = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{later.size() / 2, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string refused = message<std::runtime_error>(file("old"), later);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, on_signal);
  EXPECT_NE(refused.find("old: cannot be written: "), std::string::npos) << refused;
  EXPECT_EQ(readStateFile(file("old")), saved_);
  EXPECT_EQ(files(), 1u) << "the part must not stay";
}

TEST_F(StateFile, OnlyWhatMayBeLostIsReplaced) {
  write(file("notes.txt"), "do not lose me");
  write(file("empty"), "");
  EXPECT_NE(message<InputError>(file("notes.txt"), saved_).find("would be lost"), std::string::npos);
  EXPECT_EQ(message<InputError>(file("empty"), saved_), "written");
  EXPECT_NE(message<InputError>(file("none/at/all"), saved_).find("none/at"), std::string::npos);
  EXPECT_NE(message<InputError>(folder_.string(), saved_).find("regular file"), std::string::npos);
  EXPECT_NE(message<InputError>("/dev/full", saved_).find("regular file"), std::string::npos);
  EXPECT_NE(message<InputError>("", saved_).find("name"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(files(), 2u);
}

/// Message of readStateFile(), or "read".
std::string refusal(const std::string& file, std::uint64_t most = largestState()) {
  try {
    readStateFile(file, most);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

TEST_F(StateFile, WhatCannotBeReadIsNamed) {
  EXPECT_EQ(refusal(file("absent")).find(file("absent") + ": cannot be read: No such file"), 0u);
  EXPECT_EQ(refusal(folder_.string()).find(folder_.string() + ": "), 0u);
}

TEST_F(StateFile, OnlyRegularFilesAreRead) {
  // A FIFO without a writer would block; a device may return endless zeros.
  ASSERT_EQ(mkfifo(file("fifo").c_str(), 0600), 0);
  fs::create_symlink("fifo", file("link"));
  for (const std::string& name : {std::string("/dev/null"), folder_.string(), file("fifo"), file("link")}) {
    EXPECT_EQ(refusal(name), name + ": must be a regular file");
    EXPECT_NE(message<InputError>(name, saved_).find("must be a regular file"), std::string::npos) << name;
  }
}

TEST_F(StateFile, HeaderAndSizeAreCheckedBeforeTheRestIsRead) {
  // Sparse files: they would return content that is not on the disk.
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 40;
  const auto grow = [&](const std::string& name, const std::string& start) {
    write(file(name), start);
    EXPECT_EQ(truncate(file(name).c_str(), static_cast<off_t>(kHuge)), 0);
    return file(name);
  };
  EXPECT_NE(refusal(grow("zeros", "")).find("does not begin"), std::string::npos);
  EXPECT_NE(refusal(grow("grown", saved_)).find("has grown"), std::string::npos);
  // The header is consistent with the file, including magic, byte order and version.
  std::string honest = saved_;
  const std::uint64_t entries = kHuge - 43;
  std::memcpy(&honest[27], &entries, sizeof(entries));
  const std::string said = refusal(grow("honest", honest), largestState(run_.scene));
  EXPECT_NE(said.find("1099511627776 bytes: must be at most"), std::string::npos) << said;
}

TEST(LargestState, LeavesRoomForEveryState) {
  for (const StateCase& run : stateCases()) {
    Simulation simulation(run.scene);
    for (int step = 0; step < run.steps; ++step) advance(run, simulation, step);
    // Excludes the overhead that all scenes have, so that the bound also holds for large ones.
    const std::uint64_t particles = largestState(run.scene) - (std::uint64_t{1} << 26);
    EXPECT_LT(simulation.saveState().size(), 0.5 * static_cast<double>(particles) + 500000.0) << run.name;
  }
}

}  // namespace
}  // namespace haptic_cloth::state_test

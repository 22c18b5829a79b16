/// Files appear under their names only when they are complete; other files stay unchanged.
#include "state/new_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "haptic_cloth/error.h"

namespace haptic_cloth::new_file_test {
namespace {

namespace fs = std::filesystem;

class NewFileTest : public testing::Test {
 protected:
  NewFileTest() : folder_(fs::temp_directory_path() / ("haptic_cloth_new_file_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~NewFileTest() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }

  /// All files of the folder with their contents.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::ostringstream text;
      if (entry.is_regular_file()) text << std::ifstream(entry.path()).rdbuf();
      found[entry.path().filename().string()] = text.str();
    }
    return found;
  }
  using Contents = std::map<std::string, std::string>;

  fs::path folder_;
};

TEST_F(NewFileTest, HasItsNameWhenItIsPublished) {
  write("a", "old");
  {
    NewFile file(folder_ / "a");
    file.stream() << "new " << 0.1;
    file.finish();
    EXPECT_EQ(contents().at("a"), "old");
    file.publish();
  }
  EXPECT_EQ(contents(), (Contents{{"a", "new 0.10000000000000001"}}));
}

TEST_F(NewFileTest, LeavesNothingWhereItIsNotPublished) {
  write("a", "old");
  { NewFile(folder_ / "a").stream() << "new"; }
  EXPECT_EQ(contents(), (Contents{{"a", "old"}}));
}

TEST_F(NewFileTest, KeepsThePermissionsOfTheFileThatItReplaces) {
  write("a", "old");
  fs::permissions(file("a"), fs::perms::owner_read | fs::perms::owner_write);
  NewFile file(folder_ / "a");
  const auto mode = [](const fs::path& path) { return fs::status(path).permissions(); };
  EXPECT_EQ(mode(file.temporaryName()), fs::perms::owner_read | fs::perms::owner_write);
  file.stream() << "new";
  file.finish();
  file.publish();
  EXPECT_EQ(mode(folder_ / "a"), fs::perms::owner_read | fs::perms::owner_write);
}

/// Root may write it all the same, so another user tries.
TEST_F(NewFileTest, AWriteProtectedFileIsRefused) {
  constexpr int kNobody = 65534, kRefused = 7;
  write("a", "old");
  fs::permissions(folder_, fs::perms::all);
  fs::permissions(file("a"), fs::perms::owner_read | fs::perms::others_read);
  const auto check = [&] {
    if (getuid() == 0 && setuid(kNobody) != 0) _exit(1);
    try {
      checkNewFile(file("a"));
    } catch (const InputError& error) {
      std::cerr << error.what();
      _exit(kRefused);
    }
    _exit(0);
  };
  EXPECT_EXIT(check(), testing::ExitedWithCode(kRefused), "a: cannot be written: Permission denied");
}

TEST_F(NewFileTest, TwoWritersOfOneNameDoNotMeet) {
  NewFile one(folder_ / "a"), two(folder_ / "a");
  one.stream() << "one";
  two.stream() << "two";
  for (NewFile* file : {&one, &two}) {
    file->finish();
    file->publish();
  }
  EXPECT_EQ(contents(), (Contents{{"a", "two"}}));
}

TEST_F(NewFileTest, OfTwoSetsAtOnceOneIsThereAsAWhole) {
  // Without locks one round in ten mixed the two sets.
  for (int round = 0; round < 50; ++round) {
    std::vector<std::thread> writers;
    std::atomic<int> ready{0};
    for (const char* const text : {"one", "two"}) {
      writers.emplace_back([&, text] {
        NewFiles files;
        for (const char* const name : {"a", "b", "c", "d"}) files.add(folder_ / name).stream() << text;
        ++ready;
        while (ready < 2) std::this_thread::yield();
        files.publish();
      });
    }
    for (std::thread& writer : writers) writer.join();
    const Contents found = contents();
    const std::string text = found.at("a");
    ASSERT_EQ(found, (Contents{{"a", text}, {"b", text}, {"c", text}, {"d", text}})) << "round " << round;
  }
}

TEST_F(NewFileTest, IsNotHeldUpByWhoKeepsTheFolder) {
  const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(folder, LOCK_EX), 0);
  NewFiles files;
  files.add(folder_ / "a").stream() << "new";
  files.publish();
  close(folder);
  EXPECT_EQ(contents(), (Contents{{"a", "new"}}));
}

TEST_F(NewFileTest, CanBeReadByThoseWhoMayReadAnyNewFile) {
  write("a", "");
  NewFile file(folder_ / "b");
  file.finish();
  file.publish();
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::status(folder_ / "b").permissions());
}

TEST_F(NewFileTest, ALongNameIsNoObstacle) {
  const std::string name(250, 'n');
  NewFile file(folder_ / name);
  file.finish();
  file.publish();
  EXPECT_EQ(contents().count(name), 1u);
}

TEST_F(NewFileTest, AllOfAGroupAppearOrNone) {
  write("first", "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto on_signal = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  std::string message;
  {
    NewFiles files;
    files.add(folder_ / "first").stream() << "new";
    files.add(folder_ / "second").stream() << std::string(100000, 'x');
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    try {
      files.publish();
    } catch (const OutputError& error) {
      message = error.what();
    }
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, on_signal);
  }
  EXPECT_NE(message.find("second: cannot be written: File too large"), std::string::npos) << message;
  EXPECT_EQ(contents(), (Contents{{"first", "old"}}));
}

TEST_F(NewFileTest, OnlyRegularFilesAreReplaced) {
  ASSERT_EQ(mkfifo(file("fifo").c_str(), 0600), 0);
  fs::create_symlink("fifo", file("link"));
  for (const fs::path& name : {file("fifo"), file("link"), folder_, fs::path("/dev/null")}) {
    std::string message = "may be written";
    try {
      checkNewFile(name);
    } catch (const InputError& error) {
      message = error.what();
    }
    EXPECT_NE(message.find("must be a regular file"), std::string::npos) << name << ": " << message;
  }
  EXPECT_NO_THROW(checkNewFile(file("new")));
}

TEST_F(NewFileTest, SaysWhyAFileCannotBe) {
  const auto message = [](const fs::path& name) -> std::string {
    try {
      checkNewFile(name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "may be written";
  };
  write("a", "old");
  EXPECT_NE(message(file("a/b")).find("Not a directory"), std::string::npos) << message(file("a/b"));
  EXPECT_NE(message(file("none/b")).find("No such file or directory"), std::string::npos);
}

TEST_F(NewFileTest, ALinkToAFileThatIsNotThereYetStays) {
  fs::create_symlink("second", file("first"));
  fs::create_symlink("target", file("second"));
  NewFile made(file("first"));
  made.stream() << "new";
  made.finish();
  made.publish();
  EXPECT_TRUE(fs::is_symlink(file("first")));
  EXPECT_EQ(contents().at("target"), "new");
}

}  // namespace
}  // namespace haptic_cloth::new_file_test

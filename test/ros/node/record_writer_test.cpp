/// Files of recordings. Criteria: a file holds every line up to the end; one that cannot or must not be
/// written is refused and left alone; of a full disk the solver does not notice.
#include "ros/node/record_writer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "haptic_cloth/error.h"

namespace haptic_cloth::record_writer_test {
namespace {

namespace fs = std::filesystem;

class RecordWriterTest : public testing::Test {
 protected:
  RecordWriterTest() : file_(testing::TempDir() + "haptic_cloth_record_" + std::to_string(getpid())) {}
  ~RecordWriterTest() override {
    for (const char* number : {"", ".1", ".2", ".3", ".1.txt"}) fs::remove(file_ + number);
  }

  std::string content(const std::string& number = "") const {
    std::ostringstream text;
    text << std::ifstream(file_ + number).rdbuf();
    return text.str();
  }

  std::unique_ptr<RecordWriter> writer() const {
    return std::make_unique<RecordWriter>(file_, openRecording(file_, "test"));
  }

  /// Message with which a file is refused.
  static std::string refusal(const std::string& file) {
    try {
      openRecording(file, "test");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const std::string file_;
};

TEST_F(RecordWriterTest, WritesEveryLineUpToTheEnd) {
  for (const std::string last : {"end 1", "end 2"}) {  // the second recording takes the place of the first
    std::string expected = "haptic_cloth recording 1\n";
    const auto writer = this->writer();
    writer->write("haptic_cloth recording 1");
    for (int k = 0; k < 100000; ++k) {
      writer->write("step " + std::to_string(k));
      expected += "step " + std::to_string(k) + '\n';
    }
    EXPECT_TRUE(writer->isOpen());
    writer->write(last);
    EXPECT_TRUE(writer->end());
    EXPECT_FALSE(writer->isOpen());
    EXPECT_FALSE(writer->end());
    writer->write("step 1");
    expected += last + '\n';
    for (int k = 0; k < 300 && content() != expected; ++k) usleep(100000);
    EXPECT_TRUE(content() == expected);
  }
}

/// A node that is started again with the same parameters must not lose what the one before has recorded.
TEST_F(RecordWriterTest, KeepsOlderRecordings) {
  const std::string begin = "haptic_cloth recording 2\n";
  for (const std::string session : {"1", "2", "3"}) {
    const auto writer = this->writer();
    writer->write("haptic_cloth recording 2");
    writer->write("end " + session);
  }
  EXPECT_EQ(content(".1"), begin + "end 1\n");
  EXPECT_EQ(content(".2"), begin + "end 2\n");
  EXPECT_EQ(content(), begin + "end 3\n");
  EXPECT_FALSE(fs::exists(file_ + ".3"));
}

TEST_F(RecordWriterTest, GivesTheNewestOfTheKeptTheHighestNumber) {
  std::ofstream(file_ + ".1.txt") << "notes";
  for (const std::string number : {".1", ".2"}) std::ofstream(file_ + number) << "end" << number;
  std::ofstream(file_) << "haptic_cloth recording 2\n";
  fs::remove(file_ + ".1");
  writer();
  EXPECT_FALSE(fs::exists(file_ + ".1"));
  EXPECT_EQ(content(".2"), "end.2");
  EXPECT_EQ(content(".3"), "haptic_cloth recording 2\n");
}

/// The name of the kept recording would be longer than a file system takes, 255 bytes.
TEST_F(RecordWriterTest, RefusesARecordingThatItCannotKeep) {
  const std::string longest = testing::TempDir() + std::string(255, 'r');
  std::ofstream(longest) << "haptic_cloth recording 2\n";
  EXPECT_NE(refusal(longest).find(longest + ".1: File name too long"), std::string::npos) << refusal(longest);
  EXPECT_TRUE(fs::exists(longest));
  fs::remove(longest);
}

TEST_F(RecordWriterTest, LeavesOtherFilesAlone) {
  std::ofstream(file_) << "the user's";
  EXPECT_EQ(refusal(file_), "test: record = " + file_ + ": must be a new file or a recording");
  EXPECT_EQ(content(), "the user's");
}

TEST_F(RecordWriterTest, LeavesTheFileOfAnotherWriterAlone) {
  {
    const auto first = writer();
    EXPECT_EQ(refusal(file_), "test: record = " + file_ + ": is being written by another program");
    first->write("haptic_cloth recording 1");
    for (int k = 0; k < 300 && content().empty(); ++k) usleep(100000);
    EXPECT_EQ(refusal(file_), "test: record = " + file_ + ": is being written by another program");
    first->write("end 1");
  }
  EXPECT_EQ(content(), "haptic_cloth recording 1\nend 1\n");
}

/// To open a FIFO that nobody reads would block for ever.
TEST_F(RecordWriterTest, LeavesAFifoAlone) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_EQ(refusal(file_), "test: record = " + file_ + ": must be a regular file");
  EXPECT_TRUE(fs::is_fifo(file_));
}

TEST_F(RecordWriterTest, RefusesAFileThatCannotBeWritten) {
  EXPECT_EQ(refusal("/nowhere/file"),
            "test: record = /nowhere/file: cannot be written: No such file or directory");
  EXPECT_EQ(refusal("/dev/full"), "test: record = /dev/full: must be a regular file");
  EXPECT_EQ(refusal(testing::TempDir()), "test: record = " + testing::TempDir() + ": must be a regular file");
}

TEST_F(RecordWriterTest, SurvivesADiskThatIsFull) {
  RecordWriter writer("/dev/full", RecordFile(std::fopen("/dev/full", "a")));
  for (int k = 0; k < 300 && writer.isOpen(); ++k) {
    writer.write("step 1");
    usleep(100000);
  }
  EXPECT_FALSE(writer.isOpen());
  EXPECT_FALSE(writer.end());
}

}  // namespace
}  // namespace haptic_cloth::record_writer_test

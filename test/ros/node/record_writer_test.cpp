/// Files of recordings. Criteria: a file holds every line up to the end; one that cannot or must not be
/// written is left alone, and the solver does not notice.
#include "ros/node/record_writer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

class RecordWriterTest : public testing::Test {
 protected:
  RecordWriterTest() : file_(testing::TempDir() + "haptic_cloth_record_" + std::to_string(getpid())) {}
  ~RecordWriterTest() override {
    for (const char* number : {"", ".1", ".2", ".3"}) fs::remove(file_ + number);
  }

  std::string content(const std::string& number = "") const {
    std::ostringstream text;
    text << std::ifstream(file_ + number).rdbuf();
    return text.str();
  }

  const std::string file_;
};

TEST_F(RecordWriterTest, WritesEveryLineUpToTheEnd) {
  for (const std::string last : {"end 1", "end 2"}) {  // the second recording takes the place of the first
    std::string expected = "haptic_cloth recording 1\n";
    RecordWriter writer(file_);
    writer.write("haptic_cloth recording 1");
    for (int k = 0; k < 100000; ++k) {
      writer.write("step " + std::to_string(k));
      expected += "step " + std::to_string(k) + '\n';
    }
    EXPECT_TRUE(writer.isOpen());
    EXPECT_TRUE(writer.end(last));
    EXPECT_FALSE(writer.isOpen());
    EXPECT_FALSE(writer.end("end 3"));
    writer.write("step 1");
    expected += last + '\n';
    for (int k = 0; k < 300 && content() != expected; ++k) usleep(100000);
    EXPECT_TRUE(content() == expected);
  }
}

/// A node that is started again with the same parameters must not lose what the one before has recorded.
TEST_F(RecordWriterTest, KeepsOlderRecordings) {
  const std::string begin = "haptic_cloth recording 2\n";
  for (const std::string session : {"1", "2", "3"}) {
    RecordWriter writer(file_);
    writer.write("haptic_cloth recording 2");
    writer.end("end " + session);
  }
  EXPECT_EQ(content(".1"), begin + "end 1\n");
  EXPECT_EQ(content(".2"), begin + "end 2\n");
  EXPECT_EQ(content(), begin + "end 3\n");
  EXPECT_FALSE(fs::exists(file_ + ".3"));
}

TEST_F(RecordWriterTest, LeavesOtherFilesAlone) {
  std::ofstream(file_) << "the user's";
  {
    RecordWriter writer(file_);
    writer.write("haptic_cloth recording 1");
  }
  EXPECT_EQ(content(), "the user's");
}

TEST_F(RecordWriterTest, LeavesTheFileOfAnotherWriterAlone) {
  {
    RecordWriter first(file_);
    first.write("haptic_cloth recording 1");
    for (int k = 0; k < 300 && content().empty(); ++k) usleep(100000);
    RecordWriter second(file_);
    second.write("haptic_cloth recording 1");
    for (int k = 0; k < 300 && second.end("end 2"); ++k) usleep(100000);  // it has ended by itself
    first.write("step 1");
    first.end("end 1");
  }
  EXPECT_EQ(content(), "haptic_cloth recording 1\nstep 1\nend 1\n");
}

/// To open a FIFO that nobody reads would block for ever, and then so would the end of the writer.
TEST_F(RecordWriterTest, LeavesAFifoAlone) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  {
    RecordWriter writer(file_);
    writer.write("haptic_cloth recording 1");
  }
  EXPECT_TRUE(fs::is_fifo(file_));
}

TEST_F(RecordWriterTest, SurvivesAFileThatCannotBeWritten) {
  RecordWriter nowhere("/nowhere/file"), folder(testing::TempDir());
  for (RecordWriter* writer : {&nowhere, &folder}) {
    for (int k = 0; k < 1000; ++k) writer->write("step 1");
    writer->end("end 1");
  }
}

}  // namespace
}  // namespace haptic_cloth

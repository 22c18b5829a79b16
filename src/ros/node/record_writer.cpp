#include "ros/node/record_writer.h"

#include <fcntl.h>
#include <ros/console.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>

namespace haptic_cloth {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(200);  ///< between two writes
constexpr std::size_t kMost = 64 << 20;                   ///< lines that may wait for the disk [bytes]
constexpr char kBegin[] = "haptic_cloth recording";

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

/// The first of PATH.1, PATH.2, … that nothing has.
std::string unusedName(const std::string& path) {
  std::error_code none;
  for (int number = 1;; ++number) {
    const std::string name = path + '.' + std::to_string(number);
    if (std::filesystem::symlink_status(name, none).type() == std::filesystem::file_type::not_found)
      return name;
  }
}

}  // namespace

RecordWriter::RecordWriter(std::string path) : path_(std::move(path)), thread_([this] { run(); }) {}

RecordWriter::~RecordWriter() {
  end("");
  thread_.join();
}

bool RecordWriter::end(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (phase_ != Phase::Open) return false;
  phase_ = Phase::Ending;
  if (!line.empty()) lines_ += line + '\n';
  ending_.notify_one();
  return true;
}

bool RecordWriter::isOpen() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return phase_ == Phase::Open;
}

void RecordWriter::write(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (phase_ != Phase::Open || lines_.size() > kMost) return;
  lines_ += line;
  lines_ += '\n';
}

void RecordWriter::run() {
  const std::string error = writeAll();
  if (error.empty()) return;
  ROS_ERROR_STREAM("the recording ends: " << path_ << ": " << error);
  const std::lock_guard<std::mutex> lock(mutex_);
  phase_ = Phase::Failed;
  lines_.clear();
}

/// Writes all lines until the end. @return what went wrong; empty: nothing
std::string RecordWriter::writeAll() {
  std::error_code none;  // what does not exist is made; a FIFO would block
  if (std::filesystem::exists(path_, none) && !std::filesystem::is_regular_file(path_, none))
    return "is there and is no regular file";
  File file(std::fopen(path_.c_str(), "a+e"));
  if (file == nullptr) return std::strerror(errno);
  std::string refused = refusal(*file);
  if (!refused.empty()) return refused;
  if (std::ftell(file.get()) > 0) {
    const std::string kept = unusedName(path_);
    // Locked until it has its other name.
    if (std::rename(path_.c_str(), kept.c_str()) != 0) return kept + ": " + std::strerror(errno);
    ROS_INFO_STREAM("the older recording is now " << kept);
    file.reset(std::fopen(path_.c_str(), "a+e"));
    if (file == nullptr) return std::strerror(errno);
    refused = refusal(*file);
    if (!refused.empty()) return refused;
  }
  ROS_INFO_STREAM("recording into " << path_);
  std::string lines;
  for (bool more = true; more;) {
    more = take(lines);
    if (lines.size() > kMost) return "the disk is too slow";
    const bool written = std::fwrite(lines.data(), 1, lines.size(), file.get()) == lines.size();
    if (!written || std::fflush(file.get()) != 0) return std::strerror(errno);
  }
  return "";
}

/// Locks the file as long as it is open. @return why a recording may not take its place; empty: it may
std::string RecordWriter::refusal(std::FILE& file) {
  // File systems without locks do not refuse.
  if (flock(fileno(&file), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return "another program is writing it";
  std::string begin(sizeof(kBegin) - 1, ' ');
  begin.resize(std::fread(&begin[0], 1, begin.size(), &file));
  return begin.empty() || begin == kBegin ? "" : "is there and is no recording";
}

/// Waits for lines. @return false: these are the last ones
bool RecordWriter::take(std::string& lines) {
  std::unique_lock<std::mutex> lock(mutex_);
  const bool ends = ending_.wait_for(lock, kPeriod, [this] { return phase_ != Phase::Open; });
  lines.clear();
  lines.swap(lines_);
  return !ends;
}

}  // namespace haptic_cloth

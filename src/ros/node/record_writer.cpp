#include "ros/node/record_writer.h"

#include <fcntl.h>
#include <ros/console.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "haptic_cloth/error.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

constexpr auto kPeriod = std::chrono::milliseconds(200);  ///< between two writes
constexpr std::size_t kMost = 64 << 20;                   ///< lines that may wait for the disk [bytes]
constexpr char kBegin[] = "haptic_cloth recording";
constexpr int kMostKept = 1000000;  ///< a file with a larger number was not named here

/// PATH.N with N above the numbers of all such files, so that the highest is always the newest.
std::string unusedName(const std::string& path) {
  const fs::path file(path);
  const std::string start = file.filename().string() + '.';
  std::error_code none;
  int highest = 0;
  fs::directory_iterator entry(fs::path(".") / file.parent_path(), none);
  for (; entry != fs::directory_iterator(); entry.increment(none)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(start, 0) != 0) continue;
    const char* last = name.data() + name.size();
    int number = 0;
    const bool numbered = std::from_chars(name.data() + start.size(), last, number).ptr == last;
    if (numbered && number <= kMostKept) highest = std::max(highest, number);
  }
  // A folder that cannot be listed may have such files, too. A name that cannot be used fails in rename().
  std::string name;
  do {
    name = path + '.' + std::to_string(++highest);
  } while (fs::exists(fs::symlink_status(name, none)));
  return name;
}

}  // namespace

RecordFile openRecording(const std::string& path, const std::string& origin) {
  const auto refuse = [&](const std::string& rule) { throw InputError(origin, "record", path, rule); };
  // Locks the file. File systems without locks do not refuse.
  const auto open = [&] {
    RecordFile file(std::fopen(path.c_str(), "a+e"));
    if (file == nullptr) refuse(std::string("cannot be written: ") + std::strerror(errno));
    if (flock(fileno(file.get()), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      refuse("is being written by another program");
    return file;
  };
  std::error_code none;  // what does not exist is made; a FIFO would block
  if (fs::exists(path, none) && !fs::is_regular_file(path, none)) refuse("must be a regular file");
  RecordFile file = open();
  std::string begin(sizeof(kBegin) - 1, ' ');
  begin.resize(std::fread(&begin[0], 1, begin.size(), file.get()));
  if (begin.empty()) return file;
  if (begin != kBegin) refuse("must be a new file or a recording");
  const std::string kept = unusedName(path);
  // The older recording is locked until it has its other name.
  if (std::rename(path.c_str(), kept.c_str()) != 0) refuse(kept + ": " + std::strerror(errno));
  ROS_INFO_STREAM("the older recording is now " << kept);
  return open();
}

RecordWriter::RecordWriter(std::string path, RecordFile file)
    : path_(std::move(path)), file_(std::move(file)), thread_([this] { run(); }) {}

RecordWriter::~RecordWriter() {
  end();
  thread_.join();
}

bool RecordWriter::end() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (phase_ != Phase::Open) return false;
  phase_ = Phase::Ending;
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
  file_.reset();
  if (error.empty()) return;
  ROS_ERROR_STREAM("the recording ends: " << path_ << ": " << error);
  const std::lock_guard<std::mutex> lock(mutex_);
  phase_ = Phase::Failed;
  lines_.clear();
}

/// Writes all lines until the end. @return what went wrong; empty: nothing
std::string RecordWriter::writeAll() {
  ROS_INFO_STREAM("recording into " << path_);
  std::string lines;
  for (bool more = true; more;) {
    more = take(lines);
    if (lines.size() > kMost) return "the disk is too slow";
    const bool written = std::fwrite(lines.data(), 1, lines.size(), file_.get()) == lines.size();
    if (!written || std::fflush(file_.get()) != 0) return std::strerror(errno);
  }
  return "";
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

/// Writes a recording while the solver runs.
#pragma once

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

namespace haptic_cloth {

/// A file to which another thread writes lines. The solver never waits for the disk. A file that cannot be
/// written ends the recording, with an error in the log, and never the node.
class RecordWriter {
 public:
  /// @param path of a file that is new, empty, or another recording, which then gets the name path.1, or the
  /// next number that is free
  explicit RecordWriter(std::string path);

  /// Writes what is left.
  ~RecordWriter();

  /// Appends a line.
  void write(const std::string& line);

  /// Tells whether lines are still written.
  bool isOpen();

  /// Appends the last line; later ones are ignored. @return false: it had ended before
  bool end(const std::string& line);

 private:
  void run();
  std::string writeAll();
  static std::string refusal(std::FILE& file);
  bool take(std::string& lines);

  std::string path_;
  std::mutex mutex_;  ///< of the two members below
  std::string lines_;
  enum class Phase { Open, Ending, Failed } phase_ = Phase::Open;
  std::condition_variable ending_;
  std::thread thread_;
};

}  // namespace haptic_cloth

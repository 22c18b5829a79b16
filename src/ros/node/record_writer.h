/// Writes a recording while the solver runs.
#pragma once

#include <condition_variable>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace haptic_cloth {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// A file that was opened for a recording, locked as long as it is open.
using RecordFile = std::unique_ptr<std::FILE, CloseFile>;

/// Opens and locks the file of a recording.
/// @param path of a file that is new, empty, or another recording, which then gets the name path.1, or that
/// with the number after the highest
/// @param origin of the path, for messages
/// @throws InputError if the file cannot be written, or holds something else, or is being written
RecordFile openRecording(const std::string& path, const std::string& origin);

/// A file to which another thread writes lines. The solver never waits for the disk. A disk that is full or
/// too slow ends the recording, with an error in the log, and never the node.
class RecordWriter {
 public:
  /// @param path for messages  @param file from openRecording()
  RecordWriter(std::string path, RecordFile file);

  /// Writes what is left.
  ~RecordWriter();

  /// Appends a line.
  void write(const std::string& line);

  /// Tells whether lines are still written.
  bool isOpen();

  /// Ends the recording: later lines are ignored. @return false: it had ended before
  bool end();

 private:
  void run();
  std::string writeAll();
  bool take(std::string& lines);

  std::string path_;
  RecordFile file_;   ///< of the thread
  std::mutex mutex_;  ///< of the two members below
  std::string lines_;
  enum class Phase { Open, Ending, Failed } phase_ = Phase::Open;
  std::condition_variable ending_;
  std::thread thread_;
};

}  // namespace haptic_cloth

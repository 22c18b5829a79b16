/// Files that appear under their names only when they are complete.
#pragma once

#include <array>
#include <filesystem>
#include <list>
#include <ostream>
#include <streambuf>
#include <string>

namespace haptic_cloth {

/// Makes sure that a file may be written there: a new one in a directory that can be written, or a
/// regular file to be replaced. Devices, FIFOs and directories are refused without being opened.
/// @throws InputError naming the file
void checkNewFile(const std::filesystem::path& file);

/// The file that `file` names: where that is a link, what it points to.
std::filesystem::path linkedFile(const std::filesystem::path& file);

/// A file written in the same directory under a temporary name that nobody else has,
/// FILE.XXXXXXXX.partial. A file of the final name stays what it was until publish(); without that
/// call nothing is left behind.
class NewFile {
 public:
  /// @param file its final name; a link is followed  @throws OutputError
  explicit NewFile(const std::filesystem::path& file);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Writes doubles with the digits that bring back the same bits.
  std::ostream& stream() { return stream_; }

  const std::filesystem::path& target() const { return target_; }
  const std::string& temporaryName() const { return name_; }

  /// Brings all of it to the disk. @throws OutputError with nothing left of it
  void finish();

  /// Renames it to its final name. @pre finish()  @throws OutputError
  void publish();

 private:
  /// Unbuffered streams would cost a call of the system for every number.
  class Buffer : public std::streambuf {
   public:
    void open(int descriptor);
    int error() const { return error_; }  ///< errno of the first write that failed, or 0

   protected:
    int_type overflow(int_type next) override;
    int sync() override;

   private:
    int descriptor_ = -1, error_ = 0;
    std::array<char, 1 << 16> bytes_;
  };

  [[noreturn]] void fail(int error) const;

  std::filesystem::path target_;
  std::string name_;  ///< the temporary one
  int descriptor_ = -1;
  Buffer buffer_;
  std::ostream stream_;
};

/// Files that appear together or not at all.
class NewFiles {
 public:
  /// @throws OutputError
  NewFile& add(const std::filesystem::path& file) { return files_.emplace_back(file); }

  /// Gives all of them their names when all are complete, in the order in which they were added.
  /// Sets of several programs follow one another: the last one stays, as a whole.
  /// @throws OutputError; then none of them is there
  void publish();

 private:
  std::list<NewFile> files_;
};

}  // namespace haptic_cloth

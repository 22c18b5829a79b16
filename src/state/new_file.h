/// Files that appear under their names only when they are complete.
#pragma once

#include <array>
#include <filesystem>
#include <list>
#include <ostream>
#include <streambuf>
#include <string>

namespace haptic_cloth {

/// Checks that a file may be written: a new one in a writable directory, or a regular, writable file to be
/// replaced. Devices, FIFOs and directories are refused without being opened.
/// @throws InputError naming the file
void checkNewFile(const std::filesystem::path& file);

/// Checks the same, and that a file that would be replaced is empty or one of the same kind.
/// @param begin first bytes of this kind of file
/// @param kind what the file must be, for the message: "a state"
/// @throws InputError naming the file
void checkNewFile(const std::filesystem::path& file, const std::string& begin, const std::string& kind);

/// Resolves links: the file that `file` refers to.
std::filesystem::path linkedFile(const std::filesystem::path& file);

/// A file written under a unique temporary name in the same directory, FILE.XXXXXXXX.partial. A
/// file of the final name is unchanged until publish(); without that call nothing remains.
class NewFile {
 public:
  /// @param file final name; a link is followed
  /// @throws OutputError
  explicit NewFile(const std::filesystem::path& file);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Stream that writes doubles with enough digits to restore the same bits.
  std::ostream& stream() { return stream_; }

  const std::filesystem::path& target() const { return target_; }
  const std::string& temporaryName() const { return name_; }

  /// Writes everything to the disk. @throws OutputError; the destructor then removes the file
  void finish();

  /// Renames it to its final name. @pre finish()
  /// @throws OutputError
  void publish();

 private:
  /// Buffer: without it every number would cost a system call.
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
  std::string name_;  ///< temporary name
  int descriptor_ = -1;
  Buffer buffer_;
  std::ostream stream_;
};

/// Files that appear together or not at all.
class NewFiles {
 public:
  /// @throws OutputError
  NewFile& add(const std::filesystem::path& file) { return files_.emplace_back(file); }

  /// Gives all files their names once all are complete, in the order in which they were added. If
  /// several programs publish such sets at once, the last set stays, completely.
  /// @throws OutputError; then none of them exists
  void publish();

 private:
  std::list<NewFile> files_;
};

}  // namespace haptic_cloth

#include "state/new_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <limits>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "haptic_cloth/error.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

constexpr int kAttempts = 100;  ///< attempts to find a free temporary name
/// Largest part of the name that is taken from the file's own [bytes].
constexpr std::size_t kLongestName = 200;

/// Makes a name FILE.XXXXXXXX.partial.
std::string temporaryNameFor(const fs::path& target) {
  static const std::string kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  std::string middle;
  for (int k = 0; k < 8; ++k) middle += kLetters[random() % kLetters.size()];
  const std::string start = target.filename().string().substr(0, kLongestName);
  return (target.parent_path() / (start + "." + middle + ".partial")).string();
}

/// Creates a file that did not exist, with the permissions of the target or, if there is none, those of the
/// user's umask. mkstemp() would prevent others from reading it.
int createUnique(const fs::path& target, std::string& name) {
  struct stat replaced;
  const bool replaces = stat(target.c_str(), &replaced) == 0;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    name = temporaryNameFor(target);
    const int descriptor =
        open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, replaces ? 0600 : 0666);
    if (descriptor >= 0 && replaces) fchmod(descriptor, replaced.st_mode & 0777);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

/// Locks folders, so that no other run publishes files there in the meantime. Otherwise every file
/// would be complete, but the folder could hold files of both runs. The wait is limited by
/// kPatience, for instance for flock(1) around this program; file systems without locks are not
/// waited for.
class FolderLocks {
 public:
  // In sorted order, which is the same in all programs.
  explicit FolderLocks(const std::set<fs::path>& folders) {
    const auto give_up = std::chrono::steady_clock::now() + kPatience;
    for (const fs::path& folder : folders) {
      const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      if (descriptor < 0) continue;
      descriptors_.push_back(descriptor);
      while (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR) &&
             std::chrono::steady_clock::now() < give_up) {
        std::this_thread::sleep_for(kLook);
      }
    }
  }
  ~FolderLocks() {
    for (const int descriptor : descriptors_) close(descriptor);
  }
  FolderLocks(const FolderLocks&) = delete;
  FolderLocks& operator=(const FolderLocks&) = delete;

 private:
  static constexpr std::chrono::seconds kPatience{2};
  static constexpr std::chrono::milliseconds kLook{1};
  std::vector<int> descriptors_;
};

}  // namespace

fs::path linkedFile(const fs::path& file) {
  constexpr int kMostLinks = 40;  // as in the Linux kernel
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (!error) return real;
  fs::path path = fs::absolute(file);  // of a new file, to which links may lead
  for (int k = 0; k < kMostLinks && fs::is_symlink(path, error); ++k)
    path = path.parent_path() / fs::read_symlink(path, error);
  const fs::path plain = fs::weakly_canonical(path, error);
  return error ? path : plain;
}

void checkNewFile(const fs::path& file) {
  const fs::path path = linkedFile(file);
  const auto refuse = [&](const std::string& rule) { throw InputError(path.string(), "", "", rule); };
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse("must be a regular file");
  if (fs::exists(status) && access(path.c_str(), W_OK) != 0)
    refuse("cannot be written: " + std::string(std::strerror(errno)));
  const fs::path folder = path.parent_path();
  const bool is_folder = fs::is_directory(folder, error);
  if (!is_folder && !error) error = std::make_error_code(std::errc::not_a_directory);
  if (is_folder && access(folder.c_str(), W_OK | X_OK) != 0) error.assign(errno, std::generic_category());
  if (error) refuse("cannot be written: " + folder.string() + ": " + error.message());
}

void checkNewFile(const fs::path& file, const std::string& begin, const std::string& kind) {
  checkNewFile(file);
  const fs::path path = linkedFile(file);
  std::error_code error;
  if (!fs::exists(path, error)) return;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw InputError(path.string(), "", "", "cannot be read: " + std::string(std::strerror(errno)));
  std::string found(begin.size(), '\0');
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  const bool is_empty = stream.gcount() == 0;
  if (!is_empty && found != begin)
    throw InputError(path.string(), "", "", "must be " + kind + " or new: what it holds would be lost");
}

void NewFile::Buffer::open(int descriptor) {
  descriptor_ = descriptor;
  setp(bytes_.data(), bytes_.data() + bytes_.size());
}

NewFile::Buffer::int_type NewFile::Buffer::overflow(int_type next) {
  if (sync() != 0) return traits_type::eof();
  if (next != traits_type::eof()) sputc(traits_type::to_char_type(next));
  return traits_type::not_eof(next);
}

int NewFile::Buffer::sync() {
  const char* from = pbase();
  while (error_ == 0 && from < pptr()) {
    const ssize_t count = ::write(descriptor_, from, static_cast<std::size_t>(pptr() - from));
    if (count >= 0) from += count;
    if (count < 0 && errno != EINTR) error_ = errno;
  }
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  return error_ == 0 ? 0 : -1;
}

NewFile::NewFile(const fs::path& file) : target_(linkedFile(file)), stream_(&buffer_) {
  descriptor_ = createUnique(target_, name_);
  if (descriptor_ < 0) fail(errno);
  buffer_.open(descriptor_);
  stream_ << std::setprecision(std::numeric_limits<double>::max_digits10);
}

NewFile::~NewFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(name_.c_str());
}

void NewFile::finish() {
  stream_.flush();
  if (!stream_) fail(buffer_.error());
  // Some file systems do not support synchronisation (EINVAL).
  if (fsync(descriptor_) != 0 && errno != EINVAL) fail(errno);
}

void NewFile::publish() {
  if (rename(name_.c_str(), target_.c_str()) != 0) fail(errno);
  close(descriptor_);
  descriptor_ = -1;
  const int folder = open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;  // the file is there; a power cut may still bring back the old one
  fsync(folder);
  close(folder);
}

void NewFile::fail(int error) const {
  throw OutputError(target_.string(), error != 0 ? std::strerror(error) : "");
}

void NewFiles::publish() {
  for (NewFile& file : files_) file.finish();
  std::set<fs::path> folders;
  for (const NewFile& file : files_) folders.insert(file.target().parent_path());
  const FolderLocks locks(folders);
  std::vector<fs::path> published;
  try {
    for (NewFile& file : files_) {
      file.publish();
      published.push_back(file.target());
    }
  } catch (const OutputError&) {
    for (const fs::path& file : published) unlink(file.c_str());
    throw;
  }
}

}  // namespace haptic_cloth

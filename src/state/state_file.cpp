#include "haptic_cloth/state_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "haptic_cloth/error.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartial = ".partial";

/// The file itself where `file` is a link.
fs::path target(const std::string& file) {
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  return error ? fs::absolute(file) : real;
}

void requireName(const std::string& file) {
  if (file.empty()) throw InputError("state file", "", "", "must have a name");
}

/// A file of which other processes see nothing until it has its name.
class PartialFile {
 public:
  explicit PartialFile(const fs::path& target) : target_(target), name_(target.string() + kPartial) {
    unlink(name_.c_str());  // what a killed process has left
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail();
  }
  ~PartialFile() {
    if (descriptor_ < 0) return;
    close(descriptor_);
    unlink(name_.c_str());
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void write(const std::string& bytes) const {
    for (std::size_t written = 0; written < bytes.size();) {
      const ssize_t count = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
      if (count < 0 && errno != EINTR) fail();
      if (count > 0) written += count;
    }
  }

  /// Puts it in place of the target, both on the disk.
  void finish() {
    if (fsync(descriptor_) != 0) fail();
    if (rename(name_.c_str(), target_.c_str()) != 0) fail();
    close(descriptor_);
    descriptor_ = -1;
    const int folder = open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;  // the file is there; only after a power cut it may be the old one
    fsync(folder);
    close(folder);
  }

 private:
  [[noreturn]] void fail() const {
    throw std::runtime_error(target_.string() + ": cannot be written: " + std::strerror(errno));
  }

  fs::path target_;
  std::string name_;
  int descriptor_ = -1;
};

}  // namespace

void checkStateFile(const std::string& file) {
  requireName(file);
  const fs::path path = target(file);
  const auto refuse = [&](const std::string& rule) { throw InputError(path.string(), "", "", rule); };
  std::error_code error;
  if (fs::exists(path, error)) {
    if (!fs::is_regular_file(path, error)) refuse("must be a regular file");
    const std::string magic = kStateMagic;
    std::string start(magic.size(), '\0');
    std::ifstream stream(path, std::ios::binary);
    if (!stream) refuse(std::string("cannot be read: ") + std::strerror(errno));
    stream.read(&start[0], static_cast<std::streamsize>(start.size()));
    if (stream.gcount() > 0 && start != magic) refuse("must be a state or new: what it holds would be lost");
  }
  const fs::path folder = path.parent_path();
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    refuse("cannot be written: " + folder.string() + ": " + std::strerror(errno));
  }
}

void writeStateFile(const std::string& file, const std::string& state) {
  checkStateFile(file);
  PartialFile partial(target(file));
  partial.write(state);
  partial.finish();
}

std::string readStateFile(const std::string& file) {
  requireName(file);
  std::error_code error;
  if (fs::is_directory(file, error)) throw InputError(file, "", "", "must be a file, not a directory");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream) throw InputError(file, "", "", std::string("cannot be read: ") + std::strerror(errno));
  return text.str();
}

}  // namespace haptic_cloth

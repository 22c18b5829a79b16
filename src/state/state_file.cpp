#include "haptic_cloth/state_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "haptic_cloth/error.h"
#include "state/archive.h"
#include "state/new_file.h"

namespace haptic_cloth {
namespace {

// Generous bounds: a particle takes about 500 bytes and at most 4 for each probe that touches it;
// fabric and obstacles take less than 2 MiB.
constexpr std::uint64_t kMostOverhead = std::uint64_t{1} << 26, kMostPerParticle = 4096;
constexpr std::uint64_t kMostParticles = 1 << 24;

void requireName(const std::string& file) {
  if (file.empty()) throw InputError("state file", "", "", "must have a name");
  if (file.find('\0') != std::string::npos)
    throw InputError("state file", "", "", "must have a name without null bytes");
}

/// Regular file that is open for reading. Opening and reading it never wait for another process.
class RegularFile {
 public:
  explicit RegularFile(const std::string& name) : name_(name) {
    struct stat status {};
    // Devices are not even opened, because that alone has effects on some.
    if (stat(name.c_str(), &status) != 0) cannotBeRead();
    requireRegular(status);
    // Another process may have replaced it by a FIFO since.
    descriptor_ = open(name.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor_ < 0) cannotBeRead();
    try {
      if (fstat(descriptor_, &status) != 0) cannotBeRead();
      requireRegular(status);
    } catch (const InputError&) {
      close(descriptor_);
      throw;
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~RegularFile() { close(descriptor_); }
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Reads its first `count` bytes, fewer if it ends before.
  std::string read(std::size_t count) const {
    std::string bytes(count, '\0');
    std::size_t have = 0;
    while (have < count) {
      const ssize_t more = pread(descriptor_, &bytes[have], count - have, static_cast<off_t>(have));
      if (more < 0 && errno != EINTR) cannotBeRead();
      if (more == 0) break;
      if (more > 0) have += static_cast<std::size_t>(more);
    }
    bytes.resize(have);
    return bytes;
  }

 private:
  [[noreturn]] void cannotBeRead() const {
    throw InputError(name_, "", "", std::string("cannot be read: ") + std::strerror(errno));
  }
  void requireRegular(const struct stat& status) const {
    if (!S_ISREG(status.st_mode)) throw InputError(name_, "", "", "must be a regular file");
  }

  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace

std::uint64_t largestState(const Scene& scene) {
  const auto [columns, rows] = scene.cloth.particles;
  const auto particles = static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  return kMostOverhead + particles * kMostPerParticle;
}

std::uint64_t largestState() { return kMostOverhead + kMostParticles * kMostPerParticle; }

void checkStateFile(const std::string& file) {
  requireName(file);
  checkNewFile(file, kStateMagic, "a state");
}

void writeStateFile(const std::string& file, const std::string& state) {
  Archive::checkHeader(state.substr(0, Archive::headerSize()), state.size(), "state");
  checkStateFile(file);
  NewFiles files;
  files.add(file).stream() << state;
  files.publish();
}

std::string readStateFile(const std::string& file, std::uint64_t most) {
  requireName(file);
  const RegularFile regular(file);
  Archive::checkHeader(regular.read(Archive::headerSize()), regular.size(), file);
  if (regular.size() > most) {
    throw InputError(file, "size", std::to_string(regular.size()) + " bytes",
                     "must be at most " + std::to_string(most) + " for a state of this scene");
  }
  try {
    return regular.read(regular.size());
  } catch (const std::bad_alloc&) {
    throw InputError(file, "", "", "needs more memory than there is");
  }
}

}  // namespace haptic_cloth

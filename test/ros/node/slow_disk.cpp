/// Library for LD_PRELOAD. It makes a node see all files whose names contain "slow_disk" on a file
/// system that does not answer: opening one blocks for ever. A file waiting_to_load, or
/// waiting_to_save for the temporary file of a state, appears beside it when a call blocks.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <string>

namespace {

using Open = int (*)(const char*, int, ...);
using FileOpen = FILE* (*)(const char*, const char*);

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void waitForSlowDisk(const char* file) {
  if (file == nullptr || std::strstr(file, "slow_disk") == nullptr) return;
  const std::string sign = std::string(file).substr(0, std::string(file).rfind("slow_disk")) + "waiting_to_" +
                           (std::strstr(file, ".partial") != nullptr ? "save" : "load");
  close(next<Open>("open")(sign.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  while (true) pause();
}

}  // namespace

extern "C" {

int open(const char* file, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const int mode = va_arg(more, int);
  va_end(more);
  waitForSlowDisk(file);
  return next<Open>("open")(file, flags, mode);
}

int open64(const char* file, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const int mode = va_arg(more, int);
  va_end(more);
  waitForSlowDisk(file);
  return next<Open>("open64")(file, flags, mode);
}

FILE* fopen(const char* file, const char* mode) {
  waitForSlowDisk(file);
  return next<FileOpen>("fopen")(file, mode);
}

FILE* fopen64(const char* file, const char* mode) {
  waitForSlowDisk(file);
  return next<FileOpen>("fopen64")(file, mode);
}

}  // extern "C"

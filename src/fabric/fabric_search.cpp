#include "fabric/fabric_search.h"

#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "haptic_cloth/fabric.h"

namespace haptic_cloth {
namespace {

constexpr char kExtension[] = ".yaml";

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Directories of the fabrics shipped with the package: in the source tree, then installed.
std::vector<std::string> shippedDirectories() {
  std::vector<std::string> directories;
#ifdef HAPTIC_CLOTH_SOURCE_FABRICS
  directories.emplace_back(HAPTIC_CLOTH_SOURCE_FABRICS);
#endif
#ifdef HAPTIC_CLOTH_INSTALL_FABRICS
  directories.emplace_back(HAPTIC_CLOTH_INSTALL_FABRICS);
#endif
  return directories;
}

std::vector<std::string> searchDirectories(const std::string& base_directory) {
  std::vector<std::string> directories;
  if (const char* path = std::getenv("HAPTIC_CLOTH_FABRIC_PATH")) {
    std::istringstream stream(path);
    for (std::string directory; std::getline(stream, directory, ':');) {
      if (!directory.empty()) directories.push_back(directory);
    }
  }
  directories.push_back((std::filesystem::path(base_directory) / ".." / "fabrics").string());
  for (const std::string& directory : shippedDirectories()) directories.push_back(directory);
  return directories;
}

}  // namespace

std::vector<std::string> fabricCandidates(const std::string& name_or_path,
                                          const std::string& base_directory) {
  if (endsWith(name_or_path, kExtension)) {
    return {(std::filesystem::path(base_directory) / name_or_path).lexically_normal().string()};
  }
  std::vector<std::string> files;
  std::set<std::filesystem::path> places;  // a relative and an absolute directory may be the same
  std::error_code ignored;
  for (const std::string& directory : searchDirectories(base_directory)) {
    const auto file = (std::filesystem::path(directory) / (name_or_path + kExtension)).lexically_normal();
    if (places.insert(std::filesystem::absolute(file, ignored)).second) files.push_back(file.string());
  }
  return files;
}

std::vector<std::string> fabricNames(const std::string& base_directory) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const std::string& directory : searchDirectories(base_directory)) {
    for (std::filesystem::directory_iterator entry(directory, ignored), end; entry != end;
         entry.increment(ignored)) {
      if (entry->path().extension() == kExtension) names.insert(entry->path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

std::string findFabric(const std::string& name_or_path, const std::string& base_directory) {
  for (const std::string& file : fabricCandidates(name_or_path, base_directory)) {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored) && !std::filesystem::is_directory(file, ignored)) return file;
  }
  return {};
}

}  // namespace haptic_cloth

/// Files that are made of the tables of options. With HAPTIC_CLOTH_WRITE_REFERENCE in the environment
/// they are written (scripts/reference.sh), without it they are compared.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace haptic_cloth {

/// @param name path from the root of the package
inline std::string readReference(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(HAPTIC_CLOTH_SOURCE_DIR "/" + name).rdbuf();
  return text.str();
}

inline void expectText(const std::string& name, const std::string& text) {
  if (std::getenv("HAPTIC_CLOTH_WRITE_REFERENCE") != nullptr) {
    std::ofstream(HAPTIC_CLOTH_SOURCE_DIR "/" + name) << text;
  } else {
    EXPECT_EQ(readReference(name), text) << name << " is out of date: run scripts/reference.sh";
  }
}

/// Expects each table between its marks.
inline void expectTables(const std::string& name,
                         const std::vector<std::pair<std::string, std::string>>& tables) {
  std::string text = readReference(name);
  for (const auto& [title, table] : tables) {
    const std::string mark = "<!-- options of " + title + ": scripts/reference.sh -->\n";
    const std::size_t begin = text.find(mark);
    ASSERT_NE(begin, std::string::npos) << name << " has no mark: " << mark;
    const std::size_t first = begin + mark.size(), end = text.find("<!-- end of options -->", first);
    ASSERT_NE(end, std::string::npos) << name << " has no end of the options of " << title;
    text.replace(first, end - first, table);
  }
  expectText(name, text);
}

}  // namespace haptic_cloth

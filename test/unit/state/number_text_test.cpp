/// Numbers as text.
#include "state/number_text.h"

#include <gtest/gtest.h>

#include <locale>
#include <string>

namespace haptic_cloth::number_text_test {
namespace {

/// Numbers with a comma, as in much of Europe.
struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(NumberText, IsTheSameInAnyLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  EXPECT_EQ(shortestText(1.5), "1.5");
  EXPECT_EQ(readNumber("1.5e-3"), 1.5e-3);
  EXPECT_FALSE(readNumber("1,5"));
  std::locale::global(before);
}

TEST(NumberText, IsReadAsAWhole) {
  for (const char* text : {"0", "-1", "+1.", ".5", "1e3", "1E+03", "007"})
    EXPECT_TRUE(readNumber(text)) << text;
  for (const char* text :
       {"", "-", ".", "e5", "1e", "1-2", "1 ", " 1", "0x10", "nan", "inf", "1e400", "1.2.3"})
    EXPECT_FALSE(readNumber(text)) << text;
  EXPECT_EQ(readNumber(std::string(1000000, '0') + "1"), 1.0) << "of any length";
}

}  // namespace
}  // namespace haptic_cloth::number_text_test

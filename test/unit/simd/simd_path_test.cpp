/// Choice among the kernels' instruction sets. Criteria: the rules in simd/path.h.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "simd/kernels.h"
#include "simd/path.h"

namespace haptic_cloth::simd_path_test {
namespace {

const std::vector<SimdPath> kOldMachine{
    {"wide", nullptr, false}, {"middle", nullptr, true}, {"narrow", nullptr, true}};

/// Message of the refusal; "taken: NAME" if there is none.
std::string refusal(const char* wanted) {
  try {
    return "taken: " + choosePath(kOldMachine, wanted).name;
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(SimdPath, BestThatTheMachineHas) {
  EXPECT_EQ(choosePath(kOldMachine, nullptr).name, "middle");
  EXPECT_EQ(choosePath(kOldMachine, "").name, "middle");
}

TEST(SimdPath, EnvironmentNamesAnother) {
  EXPECT_EQ(choosePath(kOldMachine, "narrow").name, "narrow");
  EXPECT_EQ(choosePath(kOldMachine, "middle").name, "middle");
}

TEST(SimdPath, RefusalsNameVariableValueAndWhatThereIs) {
  EXPECT_EQ(
      refusal("wide"),
      "environment: HAPTIC_CLOTH_SIMD = wide: this machine lacks these instructions; it has middle, narrow");
  EXPECT_EQ(
      refusal("nonsense"),
      "environment: HAPTIC_CLOTH_SIMD = nonsense: no such instruction set; this machine has middle, narrow");
  EXPECT_EQ(refusal("NARROW").find("taken"), std::string::npos);
}

TEST(SimdPath, OneOfThisMachineIsInUse) {
  const std::vector<SimdPath> paths = simdPaths();
  EXPECT_EQ(choosePath(paths, instructionSet()).kernels, &kernels());
}

TEST(SimdPath, ProcessorHasAName) {
  EXPECT_NE(processorName().find(" cores"), std::string::npos) << processorName();
}

}  // namespace
}  // namespace haptic_cloth::simd_path_test

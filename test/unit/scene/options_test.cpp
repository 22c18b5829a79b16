/// Rows of options: the reference shows them as they are.
#include <gtest/gtest.h>

#include <set>

#include "scene/scene_options.h"
#include "support/reference_file.h"

namespace haptic_cloth::options_test {
namespace {

TEST(SceneOptions, TheReferenceHasTheTables) { expectTables("docs/reference/scenes.md", sceneTables()); }

TEST(SceneOptions, EveryRowHasItsOwnKeyAndASentence) {
  Scene scene;
  for (const Options& options : {worldOptions(scene), optionsOf(scene.probes[0]), optionsOf(scene.solver),
                                 optionsOf(scene.adapt), optionsOf(scene.stop)}) {
    std::set<std::string> keys;
    for (const Option& option : options) {
      EXPECT_TRUE(keys.insert(option.key).second) << option.key << " stands here twice";
      EXPECT_FALSE(option.meaning.empty()) << option.key;
    }
  }
}

}  // namespace
}  // namespace haptic_cloth::options_test

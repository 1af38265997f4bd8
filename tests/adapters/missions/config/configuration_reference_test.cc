// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/configuration_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace prospect::configuration_reference_test {
namespace {

using ::testing::HasSubstr;

TEST(ConfigurationReference, ThePageIsTheOneThatTheProgramPrints) {
  const std::string path = std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/configuration.md";
  std::ifstream file(path, std::ios::binary);
  ASSERT_TRUE(file) << path << " is missing";
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_TRUE(page.str() == configuration_reference())
      << path
      << " is stale; make it anew by `prospect config --reference > "
         "docs/reference/configuration.md`";
}

TEST(ConfigurationReference, EachKeyHasUnitRangeDefaultAndMeaning) {
  const std::string page = configuration_reference();
  EXPECT_THAT(page, HasSubstr("| `planner.weights.w_l` |  | 0 to 1e+06 | `2` | too few visible "
                              "features |\n"));
  EXPECT_THAT(page, HasSubstr("| `planner.d_safe` | m | 0 to 5 | `0.01` | hard clearance |\n"));
  EXPECT_THAT(page, HasSubstr("| `planner.unknown` |  | free, blocked, braking | `braking` |"));
  EXPECT_THAT(page, HasSubstr("| `guard.max_map_age` | s | 0 or more | `1` |"));
  EXPECT_THAT(page, HasSubstr("| `robot.motion.vy_max` | m/s |"));
  EXPECT_THAT(page, HasSubstr("| `robot.shape.size` | m | 3 numbers, 0.01 to 20 |"));
  EXPECT_THAT(page, HasSubstr("| `zones.slow[0].max_speed` | m/s | 0.01 to 100 | required |"));
  EXPECT_THAT(page, HasSubstr("`planner.options`"));
}

}  // namespace
}  // namespace prospect::configuration_reference_test

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/recorded_configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "adapters/formats/files/input_error.h"

namespace prospect::recorded_configuration_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(RecordedConfiguration, HoldsWhatTheMissionReadsWhateverTheDefaultsWere) {
  // As a version wrote it whose corners had another default: by depth and odometry of the kinematic
  // robot, which reads no image.
  const Configuration then = configuration_from_text(
      "planner: {N: 12}\nperception: {odometry: {corners: {min_strength_over_noise: 3}}}",
      "config.yaml");
  const std::string yaml = recorded_yaml(then, ConfigurationUse::kExplore);
  EXPECT_THAT(yaml, Not(HasSubstr("min_strength_over_noise")));
  EXPECT_EQ(configuration_from_text(yaml, "again.yaml").planner.N, 12);
  // By cameras it is read, and stays.
  const Configuration camera = configuration_from_text(
      "simulator: {sensors: camera}\nperception: {odometry: {corners: {min_strength_over_noise: "
      "3}}}",
      "c.yaml");
  EXPECT_THAT(recorded_yaml(camera, ConfigurationUse::kExplore),
              HasSubstr("min_strength_over_noise: 3"));
}

}  // namespace
}  // namespace prospect::recorded_configuration_test

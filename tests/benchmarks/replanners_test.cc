// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/replanners.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "benchmarks/baseline_planner.h"
#include "engine/planner/planner.h"

namespace prospect::replanners_test {
namespace {

TEST(Replanners, EachNameMakesItsPlanner) {
  const Configuration configuration = configuration_from_text("", "defaults");
  for (const std::string& name : replanner_names()) {
    const MakeReplanner make = replanner_maker(name);
    if (name == "mpc") {
      EXPECT_FALSE(make) << "the mission makes it";
      continue;
    }
    const std::unique_ptr<Replanner> planner = make(configuration);
    const bool frontier = dynamic_cast<const BaselinePlanner*>(planner.get()) != nullptr;
    const bool engine = dynamic_cast<const Planner*>(planner.get()) != nullptr;
    EXPECT_EQ(engine, name == "nearest-mpc") << name;
    EXPECT_EQ(frontier, !engine) << name;
  }
  EXPECT_THROW(replanner_maker("neerest"), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::replanners_test

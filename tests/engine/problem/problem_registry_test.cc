// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/problem_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace prospect::problem_registry_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ProblemEntry entry(const std::string& set, const std::string& name) {
  return {set, name, "of " + set, [] { return ProblemDefinition(); }};
}

std::string refusal(ProblemRegistry registry, const ProblemEntry& problem) {
  try {
    registry.add(problem);
    return "accepted";
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
}

TEST(ProblemRegistry, KeepsSetsInTheOrderOfAdding) {
  ProblemRegistry registry;
  registry.add(entry("b", "one"));
  registry.add(entry("a", "one"));
  registry.add(entry("b", "two"));
  EXPECT_THAT(registry.sets(), ElementsAre("b", "a"));
  ASSERT_EQ(registry.problems("b").size(), 2U);
  EXPECT_EQ(registry.problems("b")[1].name, "two");
  EXPECT_FALSE(registry.problems("b")[0].best_known.has_value());
  EXPECT_TRUE(registry.problems("c").empty());
}

TEST(ProblemRegistry, RefusesWhatCannotBeNamedOrMade) {
  ProblemRegistry registry;
  registry.reserve("zoo");
  registry.add(entry("a", "one"));
  EXPECT_EQ(refusal(registry, entry("a", "two")), "accepted");
  EXPECT_THAT(refusal(registry, entry("zoo", "one")), HasSubstr("named 'zoo' already"));
  EXPECT_THAT(refusal(registry, entry("a b", "one")), HasSubstr("is named 'a b'; expected"));
  EXPECT_THAT(refusal(registry, entry("a", "one")), HasSubstr("'one' of set 'a' is there already"));
  EXPECT_THAT(refusal(registry, entry("a", "")), HasSubstr("has no name"));
  ProblemEntry bad = entry("a", "three");
  bad.make = nullptr;
  EXPECT_THAT(refusal(registry, bad), HasSubstr("has no factory"));
  bad = entry("a", "three");
  bad.best_known = std::nan("");
  EXPECT_THAT(refusal(registry, bad), HasSubstr("not finite"));
}

}  // namespace
}  // namespace prospect::problem_registry_test

// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/builtin_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "engine/terms/problem_specification.h"
#include "tests/engine/problem_specifications.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::builtin_terms_test {
namespace {

std::vector<std::string> names(const Problem& problem) {
  std::vector<std::string> all;
  for (const auto& t : problem.definition().terms) all.emplace_back(t.term->name());
  return all;
}

TEST(BuiltinTerms, AreWhatProblemsAreMadeOf) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::set<std::string> met;
  for (const auto& s : test::specifications_of_every_kind()) {
    for (const std::string& name : names(*make_problem(*s.specification))) met.insert(name);
  }
  std::set<std::string> listed;
  const TermRegistry terms = builtin_terms();
  for (const auto& entry : terms.list()) {
    EXPECT_TRUE(entry->built_in);
    EXPECT_FALSE(entry->description.empty());
    EXPECT_EQ(entry->constraint, entry->weight_key.empty()) << entry->name;
    listed.insert(entry->name);
  }
  for (const std::string& name : listed) EXPECT_TRUE(met.contains(name)) << name;
}

TEST(BuiltinTerms, EachCanBeLeftOutAndTheOthersStay) {
  PlannerParameters parameters;
  parameters.weights.heading_alignment = 0.2;
  const auto made = test::specification_of("all", "unicycle_accel", parameters);
  const std::vector<std::string> all = names(*make_problem(*made.specification));
  const TermRegistry terms = builtin_terms();
  int left_out = 0;
  for (const auto& entry : terms.list()) {
    SCOPED_TRACE(entry->name);
    ProblemSpecification without = *made.specification;
    without.terms_left_out = {entry->name};
    std::vector<std::string> expected = all;
    std::erase(expected, entry->name);
    const auto problem = make_problem(without);
    EXPECT_EQ(names(*problem), expected);
    left_out += expected.size() < all.size();
  }
  EXPECT_EQ(left_out, 10) << "all but the rate limit, which this base has not";
}

}  // namespace
}  // namespace prospect::builtin_terms_test

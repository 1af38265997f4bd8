// SPDX-License-Identifier: Apache-2.0
// Problem files of problems with terms that are not built in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <stdexcept>

#include "adapters/formats/problem_file/problem_file.h"
#include "docs/examples/user_term/keep_distance.h"
#include "engine/planner/set_term.h"
#include "engine/terms/builtin_terms.h"
#include "tests/engine/problem_specifications.h"
#include "tests/engine/same_problem.h"

namespace prospect::problem_file_terms_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TermRegistry registry(int version = 1) {
  TermEntry entry{"keep_distance", "closeness to a point"};
  entry.options.assign(std::begin(kKeepDistanceOptions), std::end(kKeepDistanceOptions));
  entry.version = version;
  entry.make = [](const TermOptions& options, const TermContext& context) {
    return std::shared_ptr<const Term>(make_keep_distance(options, context));
  };
  TermRegistry terms = builtin_terms();
  terms.add(entry);
  return terms;
}

class ProblemFileTerms : public testing::Test {
 protected:
  ProblemFileTerms() : file_(testing::TempDir() + "terms_" + std::to_string(getpid()) + ".h5") {
    PlannerParameters p;
    p.N = 8;
    p.M = 4;
    p.visibility.r_max = 2.0;
    p.max_targets = 20;
    set_term(p, registry().use("keep_distance", 0.1 + 0.2,
                               {{"x", 1.0 / 3.0}, {"y", 0.2}, {"radius", 0.7}}));
    set_term(p, builtin_terms().use("input_rate", 0.0));
    const test::NamedSpecification made = test::specification_of("terms", "unicycle", p, 40);
    saved_.specification = *made.specification;
    saved_.seeds = made.seeds;
    saved_.origin.program = "a test";
    saved_.origin.world = "hall";
  }
  ~ProblemFileTerms() override { std::filesystem::remove(file_); }
  std::string refused(const TermRegistry& terms) {
    try {
      read_problem(file_, terms);
      return "read";
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
  }

  std::string file_;
  SavedProblem saved_;
};

TEST_F(ProblemFileTerms, AreReadBackToTheBit) {
  write_problem(file_, saved_);
  const ReadProblem read = read_problem(file_, registry());
  const ProblemSpecification& back = read.saved.specification;
  ASSERT_EQ(back.added_terms.size(), 1U);
  EXPECT_EQ(back.added_terms[0].entry->name, "keep_distance");
  EXPECT_EQ(back.added_terms[0].weight, 0.1 + 0.2);
  EXPECT_EQ(back.added_terms[0].options, saved_.specification.added_terms[0].options);
  EXPECT_EQ(back.terms_left_out, std::vector<std::string>{"input_rate"});
  test::expect_same_problem(*make_problem(saved_.specification), *read.problem);
  EXPECT_EQ(read.problem->definition().terms.back().term->name(), "keep_distance");
  // The term may look anywhere: the maps are whole.
  EXPECT_EQ(back.voxels->data().size(), saved_.specification.voxels->data().size());
}

TEST_F(ProblemFileTerms, AreRefusedByNameWhereTheyAreMissingOrOthers) {
  write_problem(file_, saved_);
  EXPECT_THAT(refused({}),
              AllOf(StartsWith(file_ + ": /terms/added/terms/1/name: needs the term "
                                       "'keep_distance', which is not there; expected the plug-in"),
                    testing::Not(HasSubstr("\n"))));
  EXPECT_THAT(refused(registry(2)),
              HasSubstr("has options of version 1 of term 'keep_distance'; expected those of "
                        "version 2"));
}

TEST_F(ProblemFileTerms, OfBuiltInOnesAloneNeedNoneToBeRead) {
  saved_.specification.added_terms.clear();
  write_problem(file_, saved_);
  const ReadProblem read = read_problem(file_);
  EXPECT_EQ(read.saved.specification.terms_left_out, std::vector<std::string>{"input_rate"});
  test::expect_same_problem(*make_problem(saved_.specification), *read.problem);
}

}  // namespace
}  // namespace prospect::problem_file_terms_test

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/problem_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/mission_set.h"
#include "problems/r1.h"
#include "problems/zoo.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::problem_set_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    make_problem_set(text, {}, {}, false);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "accepted";
}

double cost(const BenchProblem& problem, const Eigen::VectorXd& z) {
  return problem.problem->explain(z).cost;
}

TEST(ProblemSet, ZooStartsAboveItsKnownOptima) {
  const ProblemSet zoo = make_problem_set("zoo", {}, {}, false);
  EXPECT_EQ(zoo.problems.size(), 13U);
  for (const BenchProblem& p : zoo.problems) {
    SCOPED_TRACE(p.name);
    ASSERT_EQ(p.start.x.size(), p.problem->num_variables());
    const Explanation start = p.problem->explain(p.start.x);
    EXPECT_TRUE(start.cost > *p.best_known || start.violation > 1e-6);
  }
}

TEST(ProblemSet, S30IsR1FromItsStartsWithItsBestKnown) {
  const ProblemSet s30 = make_problem_set("s30", {}, {}, false);
  ASSERT_EQ(s30.problems.size(), 30U);
  EXPECT_EQ(s30.absolute_tolerance, 0.01);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(s30.problems[i].best_known, s30_best_known()[i]);
    EXPECT_EQ(cost(s30.problems[i], r1_cold()),
              make_r1(r1_starts(17, 30)[i]).explain(r1_cold()).cost);
  }
  const ProblemSet quick = make_problem_set("s30", {}, {}, true);
  ASSERT_EQ(quick.problems.size(), 6U);
  EXPECT_EQ(quick.problems[1].name, s30.problems[5].name);
  EXPECT_EQ(cost(quick.problems[1], r1_cold()), cost(s30.problems[5], r1_cold()));
}

TEST(ProblemSet, QuadrotorsHoverAtTheStart) {
  const ProblemSet set = make_problem_set("quadrotors", {}, {}, false);
  EXPECT_EQ(set.problems.size(), 46U);
  for (const BenchProblem& p : set.problems) {
    if (p.name.starts_with("multi_swap 4")) continue;  // it is large, and like the one of two
    const Explanation start = p.problem->explain(p.start.x);
    EXPECT_GT(start.cost, 100.0) << p.name;
  }
}

TEST(ProblemSet, RefusesWhatIsNoSetInOneLine) {
  EXPECT_THAT(refusal("zo"), HasSubstr("did you mean 'zoo'?"));
  EXPECT_THAT(refusal("no/such/folder"), HasSubstr("no such file or folder; expected one of: zoo"));
  for (const std::string& name : builtin_set_names()) EXPECT_NE(builtin_set_summary(name), "");
}

/// Two problems of one mission.
class Missions : public ::testing::Test {
 protected:
  Missions() {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "below");
    static const std::vector<SavedProblem> kMet = [] {
      std::vector<SavedProblem> met;
      capture_missions({{"plan:6"}, 1, 1, 2, 2}, read_configuration(""), {},
                       [&](const SavedProblem& saved) { met.push_back(saved); });
      return met;
    }();
    for (const SavedProblem& saved : kMet) {
      captured_.push_back(problem_file_name(saved.origin));
      const fs::path folder = captured_.size() == 1 ? folder_ : folder_ / "below";
      write_problem((folder / captured_.back()).string(), saved);
    }
  }
  ~Missions() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::path(::testing::TempDir()) / "a set of missions";
  std::vector<std::string> captured_;
};

TEST_F(Missions, AreCapturedAtTheStepsAskedForAndReadBackFromTheFolder) {
  EXPECT_EQ(captured_, (std::vector<std::string>{"plan-6_000001.h5", "plan-6_000003.h5"}));
  const ProblemSet set = make_problem_set(folder_.string(), {}, {}, false);
  EXPECT_EQ(set.name, "a set of missions");
  ASSERT_EQ(set.problems.size(), 2U);
  EXPECT_EQ(set.problems[0].name, "below/plan-6_000003");
  EXPECT_EQ(set.problems[1].name, "plan-6_000001");
  for (const BenchProblem& p : set.problems) {
    EXPECT_FALSE(p.best_known);
    EXPECT_GT(p.start.seeds.cols(), 1);
    EXPECT_EQ(p.start.x, p.start.seeds.col(0));
  }
  const ProblemSet one = make_problem_set((folder_ / captured_[0]).string(), {}, {}, false);
  ASSERT_EQ(one.problems.size(), 1U);
  EXPECT_EQ(cost(one.problems[0], one.problems[0].start.x),
            cost(set.problems[1], set.problems[1].start.x));
}

TEST_F(Missions, KeepTheirBestCosts) {
  NOT_UNDER_SANITIZERS("costs, sizes and times are those of the release build");
  ProblemSet set = make_problem_set(folder_.string(), {}, {}, false);
  set.problems[1].best_known = -0.123456789012345678;
  keep_best_known(set);
  const ProblemSet again = make_problem_set(folder_.string(), {}, {}, false);
  EXPECT_FALSE(again.problems[0].best_known);
  EXPECT_EQ(again.problems[1].best_known, set.problems[1].best_known);  // to the last bit
  for (const char* bad : {"", "[]", "{", "{\"costs\": 3}", "{\"costs\": {\"plan-6_000001\": \"\"}}",
                          "{\"costs\": {\"plan-6_000001\": 1e999}}"}) {
    std::ofstream(folder_ / "best_known.json") << bad;
    EXPECT_THAT(refusal(folder_.string()), HasSubstr("best_known.json: ")) << bad;
    EXPECT_THAT(refusal(folder_.string()), HasSubstr("; expected {\"costs\"")) << bad;
  }
}

TEST_F(Missions, AreRefusedAsAWholeIfOneFileIsDamaged) {
  std::ofstream(folder_ / "zzz.h5") << "no problem";
  EXPECT_THAT(refusal(folder_.string()), HasSubstr("zzz.h5: no HDF5 file; expected a problem"));
}

TEST(ProblemFingerprint, IsThatOfTheProblemAndItsStart) {
  const auto of = [](const FunctionProblem& p) {
    return problem_fingerprint(started(p.name, p.problem(), p.start, std::nullopt));
  };
  const FunctionProblem hs35 = zoo::hs35();
  EXPECT_EQ(of(hs35).size(), 16U);
  EXPECT_EQ(of(hs35), of(zoo::hs35()));
  FunctionProblem other = hs35;
  other.start[1] += 1e-15;
  EXPECT_NE(of(other), of(hs35));
  other = hs35;
  other.upper[0] *= 2.0;
  EXPECT_NE(of(other), of(hs35));
  other = hs35;
  other.f = [&](const Eigen::VectorXd& u) { return hs35.f(u) + 1e-12; };
  EXPECT_NE(of(other), of(hs35));
}

}  // namespace
}  // namespace prospect::problem_set_test

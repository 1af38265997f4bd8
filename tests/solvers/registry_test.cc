// SPDX-License-Identifier: Apache-2.0
#include "solvers/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "solvers/options.h"
#include "tests/solvers/problem_zoo.h"

namespace prospect::registry_test {
namespace {

std::string why_not(const std::string& name) {
  try {
    make_solver(name);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "no exception";
}

TEST(Registry, NamesTheNearestSolver) {
  EXPECT_THAT(why_not("nlopt:LD_SLQP"), testing::HasSubstr("'nlopt:LD_SLSQP'"));
  EXPECT_THAT(why_not("Ipopt"), testing::HasSubstr("'ipopt'"));
  EXPECT_THAT(why_not("sampling:mpi"), testing::HasSubstr("'sampling:mppi'"));
  EXPECT_THAT(why_not("nlopt:ld_lbfgs"), testing::HasSubstr("'nlopt:LD_LBFGS'"));
  EXPECT_THAT(why_not(""), testing::HasSubstr("unknown solver ''"));
}

TEST(Registry, ListsWhatItMakes) {
  std::set<std::string> names;
  std::string before;
  for (const SolverInfo& info : list_solvers()) {
    EXPECT_LT(before, info.name);
    before = info.name;
    names.insert(info.name);
    EXPECT_FALSE(info.description.empty());
    EXPECT_GE(info.options.size(), 4U);
    EXPECT_EQ(make_solver(info.name)->name(), info.name);
    if (info.available) continue;
    // Absent libraries leave a back end that says so.
    EXPECT_FALSE(info.needs.empty());
    const Problem problem = zoo::rosenbrock().problem();
    EXPECT_THAT(make_solver(info.name)->explain_unsupported(problem),
                testing::HasSubstr(info.needs));
    const Result r = make_solver(info.name)->solve(problem, {}, {}, {});
    EXPECT_EQ(r.stop, StopReason::kError);
    EXPECT_EQ(r.quality, Quality::kNone);
    EXPECT_THAT(r.detail, testing::HasSubstr(info.needs));
  }
  for (const char* required : {"ipopt", "nlopt", "nlopt:LD_SLSQP", "nlopt:LD_LBFGS", "nlopt:LD_MMA",
                               "nlopt:LN_BOBYQA", "hybrid", "nlopt:GN_DIRECT_L", "sampling",
                               "sampling:cem", "sampling:mppi", "sampling:search", "sqp"}) {
    EXPECT_TRUE(names.contains(required)) << required;
  }
}

TEST(Registry, RefusesOptionsOfOthers) {
  const zoo::Case c = zoo::hs76();
  const auto detail = [&](const std::string& solver, const Options& options) {
    const Result r = make_solver(solver)->solve(c.problem(), {}, options, {});
    EXPECT_EQ(r.stop, StopReason::kError) << solver;
    return r.detail;
  };
  EXPECT_THAT(detail("sampling:mppi", {{"sample", 10}}), testing::HasSubstr("'samples'"));
  EXPECT_THAT(detail("sampling:mppi", {{"samples", 3}}), testing::HasSubstr("4 to"));
  EXPECT_THAT(detail("sampling:cem", {{"elite", 0.0}}), testing::HasSubstr("above 0"));
  EXPECT_THAT(detail("sampling:cem", {{"smoothing", 1.5}}), testing::HasSubstr("up to 1"));
  EXPECT_THAT(detail("sampling:cem", {{"temperature", 0.1}}), testing::HasSubstr("unknown"));
  EXPECT_THAT(detail("sampling", {{"sigma", 0.0}}), testing::HasSubstr("above 0"));
  EXPECT_THAT(detail("sampling", {{"temperature", -1.0}}), testing::HasSubstr("above 0"));
  EXPECT_THAT(detail("sampling:search", {{"candidates", 0}}), testing::HasSubstr("1 to"));
  EXPECT_THAT(detail("sqp", {{"lifted", -1}}), testing::HasSubstr("0 to 1000"));
  EXPECT_THAT(detail("sqp", {{"least_eigenvalue", 0.0}}), testing::HasSubstr("above 0"));
  EXPECT_THAT(detail("nlopt:LD_SLSQP", {{"population", 10}}), testing::HasSubstr("unknown"));
  EXPECT_THAT(detail("nlopt:GN_ISRES", {{"population", -1}}), testing::HasSubstr("negative"));
  EXPECT_THAT(detail("nlopt:LN_BOBYQA", {{"initial_step", 2.0}}), testing::HasSubstr("0 to 1"));
  EXPECT_THAT(detail("nlopt:LD_LBFGS", {{"initial_penalty", 0}}), testing::HasSubstr("above 0"));
  EXPECT_THAT(detail("nlopt:LD_LBFGS", {{"initial_margin", -1.0}}), testing::HasSubstr("0 on"));
}

TEST(NloptBobyqa, NeedsTwoFreeVariables) {
  zoo::Case c = zoo::rosenbrock();
  c.lower[0] = c.upper[0] = 1.0;
  const auto solver = make_solver("nlopt:LN_BOBYQA");
  EXPECT_THAT(solver->explain_unsupported(c.problem()), testing::HasSubstr("at least 2"));
  EXPECT_EQ(solver->explain_unsupported(zoo::rosenbrock().problem()), "");
}

class Ipopt : public testing::Test {
 protected:
  void SetUp() override {
    for (const SolverInfo& info : list_solvers()) {
      if (info.name == "ipopt" && !info.available) GTEST_SKIP() << "needs " << info.needs;
    }
  }
  Result solve(const Options& options, const WarmStart& warm = {}) const {
    WarmStart w = warm;
    const zoo::Case c = zoo::bounded_quadratic();
    if (w.x.size() == 0) w.x = c.start;
    return make_solver("ipopt")->solve(c.problem(), w, options, {});
  }
};

TEST_F(Ipopt, TakesEveryOptionOfTheLibraryStrictly) {
  EXPECT_EQ(solve({{"bound_push", 1e-3}}).stop, StopReason::kConverged);
  EXPECT_EQ(solve({{"tol", 1e-3}, {"max_soc", 4}}).stop, StopReason::kConverged);
  const Result one = solve({{"max_iter", 1}});
  EXPECT_EQ(one.stop, StopReason::kIterationLimit) << one.detail;
  EXPECT_EQ(one.counters.iterations, 1);
  for (const auto& [options, expected] : std::vector<std::pair<Options, std::string>>{
           {{{"bound_pusch", 1e-3}}, "'bound_push'"},
           {{{"max_iter", 10.0}}, "an integer"},
           {{{"tol", std::string("small")}}, "a number"},
           {{{"tol", -1.0}}, "'tol'"},
           {{{"mu_strategy", std::string("fast")}}, "'mu_strategy'"},
           {{{"print_level", 5}}, "unknown option 'print_level'"},
           {{{"output_file", std::string("x")}}, "unknown option 'output_file'"},
           {{{"hessian_approximation", std::string("exact")}}, "unknown option"},
           {{{"linear_solver", std::string("ma97")}}, "'ma97'"},
       }) {
    const Result r = solve(options);
    EXPECT_EQ(r.stop, StopReason::kError) << expected;
    EXPECT_THAT(r.detail, testing::HasSubstr(expected));
  }
}

TEST_F(Ipopt, StartsWarmFromItsMultipliers) {
  const Result cold = solve({});
  ASSERT_EQ(cold.quality, Quality::kFeasibleOptimum);
  ASSERT_EQ(cold.next.z_upper.size(), 10);
  EXPECT_GT(cold.next.mu, 0.0);
  // The gradient at a bound that holds a variable back: t_0 = 1.5 beyond the bound 1, weight 1.
  EXPECT_NEAR(cold.next.z_upper[0], 1.0, 1e-4);
  EXPECT_NEAR(cold.next.z_lower[0], 0.0, 1e-4);
  const Result warm = solve({}, cold.next);
  WarmStart primal;
  primal.x = cold.x;
  const Result primal_only = solve({}, primal);
  EXPECT_EQ(warm.quality, Quality::kFeasibleOptimum);
  EXPECT_LE(4 * warm.counters.iterations, cold.counters.iterations);
  EXPECT_LT(warm.counters.cost_evaluations, primal_only.counters.cost_evaluations);
}

TEST_F(Ipopt, GivesTheMultipliersOfConstraints) {
  const zoo::Case c = zoo::hs12();  // active constraint, lambda = 1/2 at (2, 3)
  WarmStart w;
  w.x = c.start;
  const Result r = make_solver("ipopt")->solve(c.problem(), w, {}, {});
  ASSERT_EQ(r.next.lambda.size(), 1);
  EXPECT_NEAR(r.next.lambda[0], 0.5, 1e-4);
  const Result l = make_solver("nlopt:LD_LBFGS")->solve(c.problem(), w, {}, {});
  ASSERT_EQ(l.next.lambda.size(), 1);
  EXPECT_NEAR(l.next.lambda[0], 0.5, 1e-3);
}

TEST(Options, AreReadByTypeOnly) {
  const OptionSet set(common_options(), {{"tolerance", 1}, {"seed", 3}});
  EXPECT_EQ(set.error(), "");
  EXPECT_EQ(set.number("tolerance"), 1.0);
  EXPECT_EQ(set.common().seed, 3U);
  EXPECT_EQ(set.common().max_evaluations, 10000);
  EXPECT_TRUE(set.is_given("seed"));
  EXPECT_FALSE(set.is_given("max_evaluations"));
  EXPECT_THROW(set.number("seed"), std::logic_error);
  EXPECT_THROW(set.integer("nothing"), std::logic_error);
  EXPECT_THROW(set.text("tolerance"), std::logic_error);
}

}  // namespace
}  // namespace prospect::registry_test

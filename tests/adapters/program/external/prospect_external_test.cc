// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/external/prospect_external.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>

#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/program/cli/command_line.h"
#include "adapters/program/cli/export_problems.h"
#include "engine/problem/lifted_problem.h"
#include "tests/adapters/called_c.h"
#include "tests/engine/problem_specifications.h"
#include "tests/not_under_sanitizers.h"

// A plain program in C cannot load a library that was compiled with a sanitizer.
#define NOT_UNDER_ANY_SANITIZER() \
  if (under_sanitizers()) GTEST_SKIP() << "a plain program in C loads the library"

namespace prospect::test::prospect_external_test {
namespace {

namespace fs = std::filesystem;

class ProspectExternal : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    PlannerParameters p;
    p.N = 8;
    p.M = 4;
    p.visibility.r_max = 2.0;
    p.max_targets = 20;
    const NamedSpecification named = specification_of("small", "unicycle", p, 40);
    write_problem(folder_ + "/step 7.h5",
                  {{"test", named.name, 1, 7, 3.5}, *named.specification, named.seeds, {}});
    problem_ = read_problem(folder_ + "/step 7.h5").problem;
    ASSERT_EQ(
        reported([&](SignalGuard& signals) {
          return export_problems({folder_ + "/step 7.h5", "c", folder_}, Registries(), signals);
        }),
        0);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<Eigen::VectorXd> points(int count) const {
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> share(0.05, 0.95);
    std::vector<Eigen::VectorXd> points;
    for (int i = 0; i < count; ++i) {
      Eigen::VectorXd x = problem_->lower();
      for (double& value : x) value = share(generator);
      points.emplace_back(problem_->lower() +
                          x.cwiseProduct(problem_->upper() - problem_->lower()));
    }
    return points;
  }

  const std::string folder_ = ::testing::TempDir() + "external_" + std::to_string(getpid());
  const std::string library_ = "-L" + fs::path(PROSPECT_EXTERNAL).parent_path().string() +
                               " -lprospect_external -Wl,-rpath," +
                               fs::path(PROSPECT_EXTERNAL).parent_path().string();
  std::shared_ptr<const Problem> problem_;
};

TEST_F(ProspectExternal, TellsTheValuesOfTheProblemInC) {
  NOT_UNDER_ANY_SANITIZER();
  const std::vector<Eigen::VectorXd> at = points(100);
  const CalledC called = called_c(folder_, "step_7", "step_7", at, library_);
  ASSERT_EQ(called.n, problem_->num_variables());
  ASSERT_EQ(called.m, problem_->num_constraints());
  EXPECT_EQ(called.lbx, problem_->lower());
  EXPECT_EQ(called.ubx, problem_->upper());
  EXPECT_EQ(called.lbg, Eigen::VectorXd::Zero(called.m));
  Workspace workspace = problem_->make_workspace();
  Evaluation e;
  for (std::size_t i = 0; i < at.size(); ++i) {
    ASSERT_TRUE(problem_->evaluate(at[i], Evaluate::kGradient, workspace, e));
    const CalledC::At& c = called.at[i];
    ASSERT_EQ(c.code, 0);
    EXPECT_EQ(c.f, e.cost[0]);
    EXPECT_EQ(c.gradient, e.gradient);
    EXPECT_EQ(c.g, e.constraints.col(0));
    EXPECT_EQ(dense_jacobian(called, c), e.jacobian);
    EXPECT_LE(
        (c.lagrangian - 2.0 * e.gradient - 3.0 * e.jacobian.colwise().sum().transpose()).norm(),
        1e-9 * std::max(1.0, e.gradient.norm()));
  }
}

TEST_F(ProspectExternal, TellsTheSameByStages) {
  NOT_UNDER_ANY_SANITIZER();
  const LiftedProblem lifted(problem_);
  std::vector<Eigen::VectorXd> at;
  for (const Eigen::VectorXd& z : points(100)) {
    at.push_back(lifted.lifted(z));
    at.back().array() += 0.01;  // the states follow no inputs
  }
  const CalledC called = called_c(folder_, "step_7", "step_7_stages", at, library_);
  ASSERT_EQ(called.n, lifted.num_variables());
  EXPECT_EQ(called.starts, lifted.pattern().starts);
  EXPECT_EQ(called.rows, lifted.pattern().rows);
  const int gaps = 8 * problem_->horizon().nx();
  EXPECT_EQ(called.ubg.head(gaps), Eigen::VectorXd::Zero(gaps));
  EXPECT_TRUE(std::isinf(called.ubg[gaps]));
  LiftedProblem::Value value;
  for (std::size_t i = 0; i < at.size(); ++i) {
    ASSERT_TRUE(lifted.evaluate(at[i], value));
    const CalledC::At& c = called.at[i];
    ASSERT_EQ(c.code, 0);
    EXPECT_EQ(c.f, value.cost);
    EXPECT_EQ(c.gradient, value.gradient);
    EXPECT_EQ(c.g, value.constraints);
    EXPECT_EQ(c.jacobian, value.jacobian);
  }
}

TEST_F(ProspectExternal, FindsTheFileBesideTheLibraryThatWasMoved) {
  NOT_UNDER_ANY_SANITIZER();
  const std::string moved = folder_ + "/moved";
  fs::create_directories(moved);
  fs::rename(folder_ + "/step_7.h5", moved + "/step_7.h5");
  fs::rename(folder_ + "/step_7.c", moved + "/step_7.c");
  const CalledC called =
      called_c(moved, "step_7", "nlp", points(1), "-DPROSPECT_NAME=nlp " + library_);
  EXPECT_EQ(called.at[0].code, 0);
}

TEST_F(ProspectExternal, TakesNoFileForAnother) {
  const auto evaluate = [&](const std::string& file, int n, int m, int nonzeros) {
    const Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    double f = 0.0;
    const prospect_external_problem problem{file.c_str(), nullptr, 0, n, m, nonzeros};
    const prospect_external_values values{&f, nullptr, nullptr, nullptr};
    return prospect_external_evaluate(&problem, x.data(), &values);
  };
  const int n = problem_->num_variables(), m = problem_->num_constraints();
  const int nonzeros = column_pattern(*problem_).nonzeros();
  const std::string file = folder_ + "/step_7.h5";
  EXPECT_EQ(evaluate(file, n, m, nonzeros), 0);
  testing::internal::CaptureStderr();
  EXPECT_EQ(evaluate(file, n + 1, m, nonzeros), 2);
  EXPECT_EQ(evaluate(folder_ + "/no.h5", n, m, nonzeros), 2);
  EXPECT_EQ(evaluate(folder_ + "/no.h5", n, m, nonzeros), 2);  // told once
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_NE(told.find("another problem than the one that was exported; expected 9 variables"),
            std::string::npos)
      << told;
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 2);
}

}  // namespace
}  // namespace prospect::test::prospect_external_test

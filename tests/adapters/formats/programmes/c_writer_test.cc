// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/c_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"
#include "tests/adapters/called_c.h"

namespace prospect::c_writer_test {
namespace {

namespace fs = std::filesystem;

class CWriter : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static std::vector<Eigen::VectorXd> points(const StatedProgramme& p, int count) {
    std::mt19937 generator(9);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<Eigen::VectorXd> points;
    for (int i = 0; i < count; ++i) {
      Eigen::VectorXd x = p.lower;
      for (double& value : x) value = share(generator);
      points.emplace_back(p.lower + x.cwiseProduct(p.upper - p.lower));
    }
    return points;
  }

  /// Value and derivatives at a hundred points are those of the expressions.
  void expect_same(const StatedProgramme& p, const std::string& name, int count = 100) {
    SCOPED_TRACE(p.name);
    std::ofstream(folder_ + "/" + name + ".c") << c_text(p, name, "a comment");
    const std::vector<Eigen::VectorXd> at = points(p, count);
    const test::CalledC called = test::called_c(folder_, name, name, at, "-lm");
    ASSERT_EQ(called.n, p.start.size());
    ASSERT_EQ(called.m, static_cast<int>(p.rows.size()));
    EXPECT_EQ(called.x0, p.start);
    EXPECT_EQ(called.lbx, p.lower);
    EXPECT_EQ(called.ubx, p.upper);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const test::CalledC::At& c = called.at[i];
      EXPECT_EQ(c.code, 0);
      const double f = p.objective.value(at[i]);
      EXPECT_NEAR(c.f, f, 1e-9 * std::max(1.0, std::abs(f)));
      const Eigen::VectorXd gradient = p.objective.gradient(at[i]);
      EXPECT_LE((c.gradient - gradient).norm(), 1e-9 * std::max(1.0, gradient.norm()));
      const Eigen::MatrixXd J = test::dense_jacobian(called, c);
      Eigen::VectorXd lagrangian = 2.0 * gradient;
      for (std::size_t r = 0; r < p.rows.size(); ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        EXPECT_EQ(called.lbg[row], p.rows[r].lower);
        EXPECT_EQ(called.ubg[row], p.rows[r].upper);
        EXPECT_NEAR(c.g[row], p.rows[r].body.value(at[i]),
                    1e-9 * std::max(1.0, std::abs(c.g[row])));
        const Eigen::VectorXd by_x = p.rows[r].body.gradient(at[i]);
        EXPECT_LE((J.row(row).transpose() - by_x).norm(), 1e-9 * std::max(1.0, by_x.norm()));
        lagrangian += 3.0 * by_x;
      }
      EXPECT_LE((c.lagrangian - lagrangian).norm(), 1e-9 * std::max(1.0, lagrangian.norm()));
    }
  }

  const std::string folder_ = ::testing::TempDir() + "c_writer_" + std::to_string(getpid());
};

TEST_F(CWriter, TellsTheValuesOfTheZoo) {
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    int i = 0;
    for (const FunctionProblem& p : problems) {
      // Compiling takes the time of this test: those with rows, and one without.
      if (p.rows > 0 || i == 0) expect_same(p.stated(), "zoo_" + std::to_string(i));
      ++i;
    }
  }
  expect_same(path_problem(2).stated, "path");
}

TEST_F(CWriter, TellsTheValuesOfR1) { expect_same(r1_stated(), "r1", 100); }

TEST_F(CWriter, HasEveryOperationOfExpressions) {
  using Operation = Expression::Operation;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  StatedProgramme p{"operations",
                    Eigen::Vector3d(0.5, 0.5, 0.5),
                    Eigen::Vector3d(0.1, 0.1, 0.1),
                    Eigen::Vector3d(0.9, 0.9, 0.9),
                    Expression("x1", 3),
                    {},
                    std::nullopt};
  for (int code = static_cast<int>(Operation::kNegate); code < Expression::kOperations; ++code) {
    const auto operation = static_cast<Operation>(code);
    // x1 + 1 for the arc of the hyperbolic cosine.
    const bool above_one = operation == Operation::kAcosh;
    p.rows.push_back({Expression({{Operation::kVariable, 0},
                                  {Operation::kVariable, 1},
                                  {Operation::kVariable, 2},
                                  {Operation::kNumber, 0, 0, 0, above_one ? 1.0 : 0.0},
                                  {Operation::kAdd, 0, 3},
                                  {operation, 4, 1, 2}},
                                 3),
                      -kNone, code % 2 == 0 ? 1.0 : kNone});
  }
  expect_same(p, "operations");
}

TEST_F(CWriter, SaysWhereTheFunctionsAreNotDefined) {
  const StatedProgramme p{"root",
                          Eigen::VectorXd::Constant(1, 1.0),
                          Eigen::VectorXd::Constant(1, -1.0),
                          Eigen::VectorXd::Constant(1, 1.0),
                          Expression("sqrt(x1)", 1),
                          {},
                          std::nullopt};
  std::ofstream(folder_ + "/root.c") << c_text(p, "root", "");
  // Under another name, and with the whole numbers of acados.
  const test::CalledC called =
      test::called_c(folder_, "root", "nlp",
                     {Eigen::VectorXd::Constant(1, -0.5), Eigen::VectorXd::Constant(1, 0.25)},
                     "-DPROSPECT_NAME=nlp -lm");
  EXPECT_EQ(called.at[0].code, 1);
  EXPECT_EQ(called.at[1].code, 0);
  EXPECT_EQ(called.at[1].f, 0.5);
  test::run_command("cc -Wall -Wextra -Werror -Dcasadi_int=int -c " + folder_ + "/root.c -o " +
                    folder_ + "/root.o");
}

}  // namespace
}  // namespace prospect::c_writer_test

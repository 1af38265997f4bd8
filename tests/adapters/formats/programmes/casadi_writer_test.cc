// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/casadi_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "adapters/formats/programmes/c_writer.h"
#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"
#include "tests/adapters/called_c.h"

namespace prospect::casadi_writer_test {
namespace {

namespace fs = std::filesystem;

class CasadiWriter : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  /// The numbers of the next line.
  static std::vector<double> line(std::istream& from) {
    std::string text;
    std::getline(from, text);
    std::istringstream words(text);
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
      numbers.push_back(std::strtod(word.c_str(), nullptr));
    }
    return numbers;
  }
  static void expect_numbers(const std::vector<double>& told, const Eigen::VectorXd& expected,
                             double tolerance) {
    ASSERT_EQ(told.size(), static_cast<std::size_t>(expected.size()));
    double size = 1.0;
    for (const double value : expected) {
      if (std::isfinite(value)) size = std::max(size, std::abs(value));
    }
    for (std::size_t i = 0; i < told.size(); ++i) {
      const double value = expected[static_cast<Eigen::Index>(i)];
      if (std::isinf(value)) {
        EXPECT_EQ(told[i], value);
      } else {
        EXPECT_NEAR(told[i], value, tolerance * size);
      }
    }
  }

  /// What CasADi, of the folder `casadi`, makes of `arguments` is the programme.
  void expect_same(const StatedProgramme& p, const std::string& arguments,
                   const std::string& casadi, int count) const {
    SCOPED_TRACE(p.name);
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<Eigen::VectorXd> points;
    std::ofstream file(folder_ + "/points");
    for (int i = 0; i < count; ++i) {
      Eigen::VectorXd x = p.lower;
      for (double& value : x) value = share(generator);
      points.emplace_back(p.lower + x.cwiseProduct(p.upper - p.lower));
      file << std::setprecision(17) << points.back().transpose() << '\n';
    }
    file.close();
    test::run_command("PYTHONPATH='" + casadi + "' PYTHONDONTWRITEBYTECODE=1 python3 " +
                      PROSPECT_SOURCE_DIR "/tests/adapters/evaluate_casadi.py " + arguments +
                      " < " + folder_ + "/points > " + folder_ + "/values");
    std::ifstream values(folder_ + "/values");
    const auto m = static_cast<Eigen::Index>(p.rows.size());
    Eigen::VectorXd lower(m), upper(m), rows(m);
    for (Eigen::Index r = 0; r < m; ++r) {
      lower[r] = p.rows[static_cast<std::size_t>(r)].lower;
      upper[r] = p.rows[static_cast<std::size_t>(r)].upper;
    }
    for (const Eigen::VectorXd& expected : {p.start, p.lower, p.upper, lower, upper}) {
      expect_numbers(line(values), expected, 0.0);
    }
    for (const Eigen::VectorXd& x : points) {
      Eigen::VectorXd jacobian(m * x.size());
      for (Eigen::Index r = 0; r < m; ++r) {
        const Expression& body = p.rows[static_cast<std::size_t>(r)].body;
        rows[r] = body.value(x);
        jacobian.segment(r * x.size(), x.size()) = body.gradient(x);
      }
      expect_numbers(line(values), Eigen::VectorXd::Constant(1, p.objective.value(x)), 1e-9);
      expect_numbers(line(values), rows, 1e-9);
      expect_numbers(line(values), p.objective.gradient(x), 1e-9);
      expect_numbers(line(values), jacobian, 1e-9);
    }
  }
  void expect_text(const StatedProgramme& p, const std::string& casadi, int count) const {
    const std::string file = folder_ + "/programme.py";
    std::ofstream(file) << casadi_text(p, "a comment");
    expect_same(p, file, casadi, count);
  }

  static bool has_python() { return std::system("python3 --version > /dev/null 2>&1") == 0; }
  const std::string folder_ = ::testing::TempDir() + "casadi_" + std::to_string(getpid());
  const std::string stand_in_ = PROSPECT_SOURCE_DIR "/tests/adapters/casadi_stand_in";
};

TEST_F(CasadiWriter, BuildsTheProgrammeWithAStandIn) {
  if (!has_python()) GTEST_SKIP() << "there is no python3";
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    for (const FunctionProblem& p : problems) expect_text(p.stated(), stand_in_, 100);
  }
  expect_text(path_problem(1).stated, stand_in_, 10);
  expect_text(r1_stated(), stand_in_, 1);
}

TEST_F(CasadiWriter, WritesEveryOperation) {
  if (!has_python()) GTEST_SKIP() << "there is no python3";
  using Operation = Expression::Operation;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  StatedProgramme p{"operations",
                    Eigen::Vector3d::Constant(0.5),
                    Eigen::Vector3d::Constant(0.1),
                    Eigen::Vector3d::Constant(0.9),
                    Expression("x1^-2-(-3)^2", 3),
                    {},
                    std::nullopt};
  for (int code = static_cast<int>(Operation::kNegate); code < Expression::kOperations; ++code) {
    const auto operation = static_cast<Operation>(code);
    const double more = operation == Operation::kAcosh ? 1.0 : 0.0;
    p.rows.push_back({Expression({{Operation::kVariable, 0},
                                  {Operation::kVariable, 1},
                                  {Operation::kVariable, 2},
                                  {Operation::kNumber, 0, 0, 0, more},
                                  {Operation::kAdd, 0, 3},
                                  {operation, 4, 1, 2}},
                                 3),
                      -kNone, 1.0});
  }
  expect_text(p, stand_in_, 100);
}

/// PROSPECT_CASADI: the folder that Python finds a built CasADi in.
TEST_F(CasadiWriter, BuildsTheProgrammeWithCasadi) {
  const char* casadi = std::getenv("PROSPECT_CASADI");
  if (casadi == nullptr) {
    GTEST_SKIP() << "PROSPECT_CASADI names no folder with CasADi for Python";
  }
  std::vector<StatedProgramme> all = {path_problem(2).stated, r1_stated()};
  for (const FunctionProblem& p : zoo::well_scaled()) all.push_back(p.stated());
  for (const StatedProgramme& p : all) {
    expect_text(p, casadi, 100);
    std::ofstream(folder_ + "/c.c") << c_text(p, "programme", "a comment");
    test::run_command("cc -O1 -shared -fPIC " + folder_ + "/c.c -o " + folder_ + "/c.so -lm");
    expect_same(p, folder_ + "/c.so programme", casadi, 100);
  }
}

}  // namespace
}  // namespace prospect::casadi_writer_test

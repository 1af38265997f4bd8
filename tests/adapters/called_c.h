// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

namespace prospect::test {

/// What a program in C, tests/adapters/call_external.c, is told by the functions of one programme.
struct CalledC {
  struct At {
    int code = 0;
    double f = 0.0;
    Eigen::VectorXd g, gradient, jacobian, lagrangian;
  };
  int n = 0, m = 0, nonzeros = 0;
  std::vector<int> starts, rows;  ///< of the Jacobian's columns
  Eigen::VectorXd x0, lbx, ubx, lbg, ubg;
  std::vector<At> at;
};

inline void run_command(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// Compiles `folder`/NAME.c by the system's cc, warnings being errors, and calls its functions at
/// the points by a program in C that was compiled so, too. symbol: of the functions. options: of
/// the compiler, for NAME.c.
inline CalledC called_c(const std::string& folder, const std::string& name,
                        const std::string& symbol, const std::vector<Eigen::VectorXd>& points,
                        const std::string& options) {
  const std::string stem = folder + "/" + name;
  const std::string flags = "cc -O2 -std=c99 -Wall -Wextra -Wpedantic -Werror ";
  run_command(flags + "-shared -fPIC " + stem + ".c -o " + stem + ".so " + options);
  const std::string call = folder + "/call";
  if (!std::filesystem::exists(call)) {
    run_command(flags +
                "-D_DEFAULT_SOURCE " PROSPECT_SOURCE_DIR "/tests/adapters/call_external.c -o " +
                call + " -ldl");
  }
  {
    std::ofstream file(stem + ".points");
    file << std::setprecision(17) << points.size() << '\n';
    for (const Eigen::VectorXd& x : points) file << x.transpose() << '\n';
  }
  run_command(call + " " + stem + ".so " + symbol + " < " + stem + ".points > " + stem + ".values");
  CalledC called;
  std::ifstream values(stem + ".values");
  const auto vector = [&](int size) {
    Eigen::VectorXd read(size);
    for (double& value : read) {
      std::string word;
      values >> word;
      value = std::strtod(word.c_str(), nullptr);
    }
    return read;
  };
  values >> called.n >> called.m >> called.nonzeros;
  called.starts.resize(static_cast<std::size_t>(called.n) + 1);
  called.rows.resize(static_cast<std::size_t>(called.nonzeros));
  for (int& value : called.starts) values >> value;
  for (int& value : called.rows) values >> value;
  called.x0 = vector(called.n);
  called.lbx = vector(called.n);
  called.ubx = vector(called.n);
  called.lbg = vector(called.m);
  called.ubg = vector(called.m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CalledC::At at;
    values >> at.code;
    at.f = vector(1)[0];
    at.g = vector(called.m);
    at.gradient = vector(called.n);
    at.jacobian = vector(called.nonzeros);
    at.lagrangian = vector(called.n);
    called.at.push_back(at);
  }
  EXPECT_TRUE(values) << "too few values";
  return called;
}

/// The Jacobian of a point, dense.
inline Eigen::MatrixXd dense_jacobian(const CalledC& called, const CalledC::At& at) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(called.m, called.n);
  for (int j = 0; j < called.n; ++j) {
    const auto column = static_cast<std::size_t>(j);
    for (int k = called.starts[column]; k < called.starts[column + 1]; ++k) {
      J(called.rows[static_cast<std::size_t>(k)], j) = at.jacobian[k];
    }
  }
  return J;
}

}  // namespace prospect::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <vector>

#include "engine/problem/problem.h"
#include "tests/engine/view_worlds.h"

namespace prospect::test {

/// The bits of every entry, so that -0 and 0 differ and a NaN equals itself.
template <typename Derived>
std::vector<std::uint64_t> bits(const Eigen::DenseBase<Derived>& values) {
  std::vector<std::uint64_t> all;
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      all.push_back(std::bit_cast<std::uint64_t>(values(i, j)));
    }
  }
  return all;
}

/// Two problems that are the same to the last bit: size, bounds, pattern, and at random points
/// (admissible, beyond the bounds, far beyond) values, constraints, gradients, Jacobians and the
/// explanation of every term.
inline void expect_same_problem(const Problem& a, const Problem& b, std::uint64_t seed = 1,
                                int points = 30) {
  ASSERT_EQ(a.num_variables(), b.num_variables());
  ASSERT_EQ(a.num_constraints(), b.num_constraints());
  EXPECT_EQ(a.definition().model->name(), b.definition().model->name());
  EXPECT_EQ(bits(a.lower()), bits(b.lower()));
  EXPECT_EQ(bits(a.upper()), bits(b.upper()));
  EXPECT_TRUE((a.jacobian_pattern() == b.jacobian_pattern()).all());
  EXPECT_EQ(a.smoothness(), b.smoothness());
  EXPECT_EQ(a.has_gradient(), b.has_gradient());

  std::mt19937_64 random(seed);
  Eigen::MatrixXd X(a.num_variables(), points);
  for (Eigen::Index c = 0; c < points; ++c) {
    const double scale = c % 3 == 0 ? 1.0 : (c % 3 == 1 ? 1.5 : 20.0);
    for (Eigen::Index i = 0; i < X.rows(); ++i) {
      X(i, c) = scale * uniform(random, a.lower()[i], a.upper()[i]);
    }
  }
  Workspace wa = a.make_workspace(), wb = b.make_workspace();
  Evaluation ea, eb;
  EXPECT_EQ(a.evaluate(X, Evaluate::kValue, wa, ea), b.evaluate(X, Evaluate::kValue, wb, eb));
  EXPECT_EQ(bits(ea.cost), bits(eb.cost));
  EXPECT_EQ(bits(ea.constraints), bits(eb.constraints));
  int valid = 0;
  for (Eigen::Index c = 0; c < points; ++c) {
    EXPECT_EQ(a.evaluate(X.col(c), Evaluate::kGradient, wa, ea),
              b.evaluate(X.col(c), Evaluate::kGradient, wb, eb));
    valid += ea.valid[0];
    EXPECT_EQ(bits(ea.cost), bits(eb.cost));
    EXPECT_EQ(bits(ea.gradient), bits(eb.gradient));
    EXPECT_EQ(bits(ea.constraints), bits(eb.constraints));
    EXPECT_EQ(bits(ea.jacobian), bits(eb.jacobian));
    const Explanation xa = a.explain(X.col(c)), xb = b.explain(X.col(c));
    ASSERT_EQ(xa.terms.size(), xb.terms.size());
    for (std::size_t i = 0; i < xa.terms.size(); ++i) {
      EXPECT_EQ(xa.terms[i].name, xb.terms[i].name);
      EXPECT_EQ(xa.terms[i].unit, xb.terms[i].unit);
      EXPECT_EQ(xa.terms[i].constraint, xb.terms[i].constraint);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(xa.terms[i].raw),
                std::bit_cast<std::uint64_t>(xb.terms[i].raw))
          << xa.terms[i].name;
      EXPECT_EQ(std::bit_cast<std::uint64_t>(xa.terms[i].weighted),
                std::bit_cast<std::uint64_t>(xb.terms[i].weighted))
          << xa.terms[i].name;
    }
  }
  EXPECT_GE(valid, points / 3);
}

}  // namespace prospect::test

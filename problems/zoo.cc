// SPDX-License-Identifier: Apache-2.0
#include "problems/zoo.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>

#include "engine/support/cholesky.h"

namespace prospect::zoo {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// The residuals of f = 1/2 x^T Q x + b^T x + f(0), Q = L L^T positive definite:
/// r = L^T x + L^-1 b.
FunctionResiduals of_quadratic(const FunctionProblem& p) {
  const Eigen::Index n = p.lower.size();
  const Vector b = p.g(Vector::Zero(n));
  Matrix Q(n, n);
  for (Eigen::Index i = 0; i < n; ++i) Q.col(i) = p.g(Vector::Unit(n, i)) - b;
  const Eigen::LLT<Matrix> cholesky(Q);
  const Matrix L = cholesky.matrixL();
  const Vector at_zero = cholesky.matrixL().solve(b);
  return {p.f(Vector::Zero(n)) - 0.5 * at_zero.squaredNorm(), static_cast<int>(n),
          [L, at_zero](const Vector& x) { return Vector(L.transpose() * x + at_zero); },
          [L](const Vector&) { return Matrix(L.transpose()); }};
}

}  // namespace

FunctionProblem rosenbrock() {
  FunctionProblem p{"Rosenbrock", vec({-2, -2}), vec({2, 2}), vec({-1.2, 1})};
  p.f = [](const Vector& x) {
    return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2);
  };
  p.g = [](const Vector& x) {
    const double r = x[1] - x[0] * x[0];
    return vec({-400 * x[0] * r - 2 * (1 - x[0]), 200 * r});
  };
  const double a = std::sqrt(200.0), b = std::sqrt(2.0);
  p.residuals = {0.0, 2,
                 [=](const Vector& x) {
                   return vec({a * (x[1] - x[0] * x[0]), b * (1 - x[0])});
                 },
                 [=](const Vector& x) {
                   Matrix J(2, 2);
                   J << -2 * a * x[0], a, -b, 0;
                   return J;
                 }};
  p.objective = "100*(x2-x1*x1)^2+(1-x1)^2";
  return p;
}

FunctionProblem bounded_quadratic() {
  constexpr int n = 10;
  FunctionProblem p{"bounded quadratic", Vector::Constant(n, -1), Vector::Constant(n, 1),
                    Vector::Zero(n)};
  Vector t(n);
  for (int i = 0; i < n; ++i) t[i] = i % 3 == 0 ? 1.5 : 0.8 * std::sin(1.0 + i);
  p.f = [t](const Vector& x) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (i + 1) * std::pow(x[i] - t[i], 2);
    return sum;
  };
  p.g = [t](const Vector& x) {
    Vector g(x.size());
    for (int i = 0; i < n; ++i) g[i] = 2 * (i + 1) * (x[i] - t[i]);
    return g;
  };
  for (int i = 0; i < n; i += 3) p.optimum += (i + 1) * 0.25;
  p.residuals = of_quadratic(p);
  for (int i = 0; i < n; ++i) {
    char part[80];
    std::snprintf(part, sizeof part, "%s%d*(x%d-(%.17g))^2", i > 0 ? "+" : "", i + 1, i + 1, t[i]);
    p.objective += part;
  }
  return p;
}

FunctionProblem hs12() {
  FunctionProblem p{"HS12", vec({-10, -10}), vec({10, 10}), vec({0, 0})};
  p.f = [](const Vector& x) {
    return 0.5 * x[0] * x[0] + x[1] * x[1] - x[0] * x[1] - 7 * x[0] - 7 * x[1];
  };
  p.g = [](const Vector& x) { return vec({x[0] - x[1] - 7, 2 * x[1] - x[0] - 7}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({25 - 4 * x[0] * x[0] - x[1] * x[1]}); };
  p.J = [](const Vector& x) { return Matrix(vec({-8 * x[0], -2 * x[1]}).transpose()); };
  p.optimum = -30;
  p.residuals = of_quadratic(p);
  p.objective = "0.5*x1*x1+x2*x2-x1*x2-7*x1-7*x2";
  p.constraints = {"25-4*x1*x1-x2*x2"};
  return p;
}

FunctionProblem hs21() {
  FunctionProblem p{"HS21", vec({2, -50}), vec({50, 50}),
                    vec({-1, -1})};  // starts outside its bounds
  p.f = [](const Vector& x) { return 0.01 * x[0] * x[0] + x[1] * x[1] - 100; };
  p.g = [](const Vector& x) { return vec({0.02 * x[0], 2 * x[1]}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({10 * x[0] - x[1] - 10}); };
  p.J = [](const Vector&) { return Matrix(vec({10, -1}).transpose()); };
  p.optimum = -99.96;
  p.residuals = of_quadratic(p);
  p.objective = "0.01*x1*x1+x2*x2-100";
  p.constraints = {"10*x1-x2-10"};
  return p;
}

FunctionProblem hs22() {
  FunctionProblem p{"HS22", vec({-5, -5}), vec({5, 5}), vec({2, 2})};  // an infeasible start
  p.f = [](const Vector& x) { return std::pow(x[0] - 2, 2) + std::pow(x[1] - 1, 2); };
  p.g = [](const Vector& x) { return vec({2 * (x[0] - 2), 2 * (x[1] - 1)}); };
  p.rows = 2;
  p.c = [](const Vector& x) { return vec({2 - x[0] - x[1], x[1] - x[0] * x[0]}); };
  p.J = [](const Vector& x) {
    Matrix J(2, 2);
    J << -1, -1, -2 * x[0], 1;
    return J;
  };
  p.optimum = 1;
  p.residuals = of_quadratic(p);
  p.objective = "(x1-2)^2+(x2-1)^2";
  p.constraints = {"2-x1-x2", "x2-x1*x1"};
  return p;
}

FunctionProblem hs29() {
  FunctionProblem p{"HS29", vec({-10, -10, -10}), vec({10, 10, 10}), vec({1, 1, 1})};
  p.f = [](const Vector& x) { return -x[0] * x[1] * x[2]; };
  p.g = [](const Vector& x) { return vec({-x[1] * x[2], -x[0] * x[2], -x[0] * x[1]}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({48 - x[0] * x[0] - 2 * x[1] * x[1] - 4 * x[2] * x[2]}); };
  p.J = [](const Vector& x) { return Matrix(vec({-2 * x[0], -4 * x[1], -8 * x[2]}).transpose()); };
  p.optimum = -16 * std::sqrt(2.0);
  p.residuals = FunctionResiduals{-1000.0};
  p.objective = "-x1*x2*x3";
  p.constraints = {"48-x1*x1-2*x2*x2-4*x3*x3"};
  return p;
}

FunctionProblem hs35() {
  FunctionProblem p{"HS35", vec({0, 0, 0}), vec({10, 10, 10}), vec({0.5, 0.5, 0.5})};
  p.f = [](const Vector& x) {
    return 9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + 2 * x[0] * x[0] + 2 * x[1] * x[1] + x[2] * x[2] +
           2 * x[0] * x[1] + 2 * x[0] * x[2];
  };
  p.g = [](const Vector& x) {
    return vec(
        {-8 + 4 * x[0] + 2 * x[1] + 2 * x[2], -6 + 4 * x[1] + 2 * x[0], -4 + 2 * x[2] + 2 * x[0]});
  };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({3 - x[0] - x[1] - 2 * x[2]}); };
  p.J = [](const Vector&) { return Matrix(vec({-1, -1, -2}).transpose()); };
  p.optimum = 1.0 / 9.0;
  p.residuals = of_quadratic(p);
  p.objective = "9-8*x1-6*x2-4*x3+2*x1*x1+2*x2*x2+x3*x3+2*x1*x2+2*x1*x3";
  p.constraints = {"3-x1-x2-2*x3"};
  return p;
}

FunctionProblem hs43() {
  FunctionProblem p{"HS43", Vector::Constant(4, -10), Vector::Constant(4, 10), Vector::Zero(4)};
  p.f = [](const Vector& x) {
    return x[0] * x[0] + x[1] * x[1] + 2 * x[2] * x[2] + x[3] * x[3] - 5 * x[0] - 5 * x[1] -
           21 * x[2] + 7 * x[3];
  };
  p.g = [](const Vector& x) {
    return vec({2 * x[0] - 5, 2 * x[1] - 5, 4 * x[2] - 21, 2 * x[3] + 7});
  };
  p.rows = 3;
  p.c = [](const Vector& x) {
    const Vector s = x.cwiseAbs2();
    return vec({8 - s.sum() - x[0] + x[1] - x[2] + x[3],
                10 - s[0] - 2 * s[1] - s[2] - 2 * s[3] + x[0] + x[3],
                5 - 2 * s[0] - s[1] - s[2] - 2 * x[0] + x[1] + x[3]});
  };
  p.J = [](const Vector& x) {
    Matrix J(3, 4);
    J << -2 * x[0] - 1, -2 * x[1] + 1, -2 * x[2] - 1, -2 * x[3] + 1,  //
        -2 * x[0] + 1, -4 * x[1], -2 * x[2], -4 * x[3] + 1,           //
        -4 * x[0] - 2, -2 * x[1] + 1, -2 * x[2], 1;
    return J;
  };
  p.optimum = -44;
  p.residuals = of_quadratic(p);
  p.objective = "x1*x1+x2*x2+2*x3*x3+x4*x4-5*x1-5*x2-21*x3+7*x4";
  p.constraints = {"8-x1*x1-x2*x2-x3*x3-x4*x4-x1+x2-x3+x4", "10-x1*x1-2*x2*x2-x3*x3-2*x4*x4+x1+x4",
                   "5-2*x1*x1-x2*x2-x3*x3-2*x1+x2+x4"};
  return p;
}

FunctionProblem hs76() {
  FunctionProblem p{"HS76", Vector::Zero(4), Vector::Constant(4, 10), Vector::Constant(4, 0.5)};
  p.f = [](const Vector& x) {
    return x[0] * x[0] + 0.5 * x[1] * x[1] + x[2] * x[2] + 0.5 * x[3] * x[3] - x[0] * x[2] +
           x[2] * x[3] - x[0] - 3 * x[1] + x[2] - x[3];
  };
  p.g = [](const Vector& x) {
    return vec({2 * x[0] - x[2] - 1, x[1] - 3, 2 * x[2] - x[0] + x[3] + 1, x[3] + x[2] - 1});
  };
  p.rows = 3;
  p.c = [](const Vector& x) {
    return vec({5 - x[0] - 2 * x[1] - x[2] - x[3], 4 - 3 * x[0] - x[1] - 2 * x[2] + x[3],
                x[1] + 4 * x[2] - 1.5});
  };
  p.J = [](const Vector&) {
    Matrix J(3, 4);
    J << -1, -2, -1, -1, -3, -1, -2, 1, 0, 1, 4, 0;
    return J;
  };
  p.optimum = -4.681818181818182;
  p.residuals = of_quadratic(p);
  p.objective = "x1*x1+0.5*x2*x2+x3*x3+0.5*x4*x4-x1*x3+x3*x4-x1-3*x2+x3-x4";
  p.constraints = {"5-x1-2*x2-x3-x4", "4-3*x1-x2-2*x3+x4", "x2+4*x3-1.5"};
  return p;
}

FunctionProblem camel() {
  FunctionProblem p{"six-hump camel", vec({-3, -2}), vec({3, 2}), vec({-1.8, 0.9})};
  p.f = [](const Vector& x) {
    const double a = x[0] * x[0], b = x[1] * x[1];
    return (4 - 2.1 * a + a * a / 3) * a + x[0] * x[1] + (-4 + 4 * b) * b;
  };
  p.g = [](const Vector& x) {
    const double a = x[0] * x[0];
    return vec({8 * x[0] - 8.4 * x[0] * a + 2 * x[0] * a * a + x[1],
                x[0] - 8 * x[1] + 16 * x[1] * x[1] * x[1]});
  };
  p.optimum = -1.031628453489877;
  p.several_basins = true;
  // f = -81/64 + 1/2 (x + y)^2 + x^2 q + (2 y^2 - 9/8)^2, q = 3.5 - 2.1 x^2 + x^4 / 3 > 0.
  p.residuals = {-81.0 / 64.0, 3,
                 [](const Vector& x) {
                   const double s = x[0] * x[0], q = 3.5 - 2.1 * s + s * s / 3;
                   return vec({x[0] + x[1], x[0] * std::sqrt(2 * q),
                               std::sqrt(2.0) * (2 * x[1] * x[1] - 1.125)});
                 },
                 [](const Vector& x) {
                   const double s = x[0] * x[0], q = 3.5 - 2.1 * s + s * s / 3;
                   const double root = std::sqrt(2 * q);
                   Matrix J(3, 2);
                   J << 1, 1, root + s * (-4.2 + 4 * s / 3) / root, 0, 0, std::sqrt(2.0) * 4 * x[1];
                   return J;
                 }};
  p.objective = "(4-2.1*x1^2+x1^4/3)*x1^2+x1*x2+(-4+4*x2^2)*x2^2";
  return p;
}

FunctionProblem pressure() {
  FunctionProblem p{"pressure", vec({1e4, 0}), vec({1e6, 5}), vec({1e5, 0.3})};
  p.f = [](const Vector& x) {
    return std::pow(x[0] / 1e5 - 3, 2) + 100 * std::pow(x[1] - x[0] / 4e5, 2);
  };
  p.g = [](const Vector& x) {
    const double r = x[1] - x[0] / 4e5;
    return vec({2e-5 * (x[0] / 1e5 - 3) - 5e-4 * r, 200 * r});
  };
  p.residuals = {0.0, 2,
                 [](const Vector& x) {
                   return Vector(std::sqrt(2.0) * vec({x[0] / 1e5 - 3, 10 * (x[1] - x[0] / 4e5)}));
                 },
                 [](const Vector&) {
                   Matrix J(2, 2);
                   J << 1e-5, 0, -2.5e-5, 10;
                   return Matrix(std::sqrt(2.0) * J);
                 }};
  p.objective = "(x1/1e5-3)^2+100*(x2-x1/4e5)^2";
  return p;
}

FunctionProblem cargo() {
  FunctionProblem p{"cargo", vec({0.4, 4e4, 9e3}), vec({1.8, 2.2e5, 9e4}), vec({0.6, 6e4, 1.2e4})};
  p.f = [](const Vector& x) { return -0.4 * (x[1] + x[2] - 1.5e5) * std::pow(x[0] + 1, 2); };
  p.g = [](const Vector& x) {
    const double s = -0.4 * std::pow(x[0] + 1, 2);
    return vec({-0.8 * (x[1] + x[2] - 1.5e5) * (x[0] + 1), s, s});
  };
  p.optimum = -501760;
  p.residuals = FunctionResiduals{p.optimum};
  p.objective = "-0.4*(x2+x3-1.5e5)*(x1+1)^2";
  return p;
}

std::vector<FunctionProblem> well_scaled() {
  return {rosenbrock(), bounded_quadratic(), hs12(), hs21(), hs22(), hs29(), hs35(), hs43(), hs76(),
          camel()};
}

std::vector<FunctionProblem> badly_scaled() { return {pressure(), cargo()}; }

}  // namespace prospect::zoo

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "problems/function_problem.h"

/// Programmes made to draw false claims out of back ends, over scales, offsets and dimensions.
namespace prospect::hostile {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

struct Programme {
  FunctionProblem of;           ///< `optimum`: of every local minimum
  bool feasible = true;         ///< whether it has a feasible point
  double change = 1.0;          ///< a difference of cost that matters; also: start and optimum
  Vector unit = {};             ///< by which a violation of each constraint counts, rows; empty: 1
  bool must_be_solved = false;  ///< by the local methods with derivatives that take constraints
};

/// How far the cost is above the minimum, as a share of what matters.
inline double gap(const Programme& made, double cost) {
  const double fallen = std::abs(made.of.f(made.of.start) - made.of.optimum);
  const double matters = std::max(made.change, std::isfinite(fallen) ? fallen : 0.0);
  return (cost - made.of.optimum) / matters;
}

/// The largest violation, each constraint divided by its unit.
inline double violation(const Programme& made, const Vector& x) {
  if (made.of.rows == 0) return 0.0;
  const Vector c = made.of.c(x);
  const Vector scaled = made.unit.size() > 0 ? Vector(c.cwiseQuotient(made.unit)) : c;
  return std::max(0.0, -scaled.minCoeff());
}

/// A seeded source of numbers.
class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(generator_() >> 11) * 0x1p-53;
  }
  int whole(int low, int high) { return static_cast<int>(std::floor(uniform(low, high + 1.0))); }
  /// 1e-8 to 1e8.
  double scale() { return std::pow(10.0, whole(-8, 8)); }
  Vector vector(int n, double low, double high) {
    Vector v(n);
    for (double& x : v) x = uniform(low, high);
    return v;
  }
  Matrix rotation(int n) {
    Matrix m(n, n);
    for (double& x : m.reshaped()) x = uniform(-1.0, 1.0);
    return Eigen::HouseholderQR<Matrix>(m).householderQ();
  }

 private:
  std::mt19937_64 generator_;
};

/// f(R x) for f and gradient of y.
inline void set_rotated(FunctionProblem& p, Matrix R, FunctionCost::Value f,
                        FunctionCost::Gradient g) {
  p.f = [R, f](const Vector& x) { return f(R * x); };
  p.g = [R, g](const Vector& x) { return Vector(R.transpose() * g(R * x)); };
}

/// scale f + offset, with everything that goes with it.
inline Programme restated(Programme made, double scale, double offset) {
  FunctionProblem& p = made.of;
  p.f = [f = p.f, scale, offset](const Vector& x) { return offset + scale * f(x); };
  p.g = [g = p.g, scale](const Vector& x) { return Vector(scale * g(x)); };
  if (p.residuals) {
    FunctionResiduals& of = *p.residuals;
    const double root = std::sqrt(scale);
    of.offset = offset + scale * of.offset;
    of.r = [r = of.r, root](const Vector& x) { return Vector(root * r(x)); };
    of.J = [J = of.J, root](const Vector& x) { return Matrix(root * J(x)); };
  }
  p.optimum = offset + scale * p.optimum;
  made.change *= scale;
  p.name += ", cost " + std::to_string(std::log10(scale)).substr(0, 4) + ", offset " +
            std::to_string(offset);
  return made;
}

/// c times a unit, row by row.
inline Programme in_units(Programme made, const Vector& units) {
  FunctionProblem& p = made.of;
  p.c = [c = p.c, units](const Vector& x) { return Vector(c(x).cwiseProduct(units)); };
  p.J = [J = p.J, units](const Vector& x) { return Matrix(units.asDiagonal() * J(x)); };
  made.unit = units;
  p.name += ", constraint " + std::to_string(std::log10(units[0])).substr(0, 4);
  return made;
}

inline FunctionProblem boxed(const std::string& name, int n, double half, const Vector& start) {
  FunctionProblem p;
  p.name = name + " " + std::to_string(n);
  p.lower = Vector::Constant(n, -half);
  p.upper = Vector::Constant(n, half);
  p.start = start;
  return p;
}

inline void add_rows(FunctionProblem& p, const Matrix& A, const Vector& b) {
  p.rows = static_cast<int>(b.size());
  p.c = [A, b](const Vector& x) { return Vector(A * x + b); };
  p.J = [A](const Vector&) { return A; };
}

/// 1/2 (x - t)^T Q (x - t).
inline Programme bowl(Draw& draw, int n) {
  Programme made{boxed("bowl", n, 10.0, draw.vector(n, -8.0, 8.0))};
  const Matrix R = draw.rotation(n);
  Vector q(n);
  for (double& x : q) x = std::pow(10.0, draw.uniform(-1.0, 1.0));
  const Vector t = draw.vector(n, -5.0, 5.0);
  set_rotated(
      made.of, R, [q, t](const Vector& y) { return 0.5 * (y - t).cwiseAbs2().dot(q); },
      [q, t](const Vector& y) { return Vector(q.cwiseProduct(y - t)); });
  made.of.residuals = {
      0.0, n, [R, q, t](const Vector& x) { return Vector(q.cwiseSqrt().cwiseProduct(R * x - t)); },
      [R, q](const Vector&) { return Matrix(q.cwiseSqrt().asDiagonal() * R); }};
  // Within the bounds, whatever R is.
  made.of.lower.setConstant(-50.0);
  made.of.upper.setConstant(50.0);
  made.must_be_solved = true;
  return made;
}

/// 1/2 |x - t|^2 beyond a plane through the middle, on which its minimum is.
inline Programme plane(Draw& draw, int n) {
  Programme made{boxed("plane", n, 50.0, Vector::Zero(n))};
  const Vector a = draw.vector(n, 0.5, 1.5), t = draw.vector(n, 2.0, 4.0);
  const double b = 0.5 * a.dot(t);
  made.of.f = [t](const Vector& x) { return 0.5 * (x - t).squaredNorm(); };
  made.of.g = [t](const Vector& x) { return Vector(x - t); };
  made.of.optimum = 0.5 * std::pow(a.dot(t) - b, 2) / a.squaredNorm();
  add_rows(made.of, -a.transpose(), Vector::Constant(1, b));
  made.must_be_solved = true;
  return made;
}

/// The same with its constraint several times over, in several units.
inline Programme repeated(Draw& draw, int n) {
  Programme made = plane(draw, n);
  made.of.name = "repeated " + std::to_string(n);
  const Matrix once = made.of.J(Vector::Zero(n));
  const double b = made.of.c(Vector::Zero(n))[0];
  const Vector times = (Vector(4) << 1.0, 1.0, 2.0, 7.0).finished();
  add_rows(made.of, times * once, times * b);
  return made;
}

/// A maximum or a saddle of sum_i (+-y_i^2 + y_i^4 / 4), all of whose minima are alike.
inline Programme saddle(Draw& draw, int n, int up, bool at_it) {
  Programme made{boxed(up == 0 ? "maximum" : "saddle", n, 20.0, Vector::Zero(n))};
  Vector sign = Vector::Constant(n, -1.0);
  sign.head(up).setConstant(1.0);
  const Matrix R = draw.rotation(n);
  set_rotated(
      made.of, R,
      [sign](const Vector& y) { return y.cwiseAbs2().dot(sign) + 0.25 * y.array().pow(4).sum(); },
      [sign](const Vector& y) {
        return Vector((2.0 * sign.array() * y.array() + y.array().cube()).matrix());
      });
  made.of.optimum = -(n - up);
  // On what leads into the saddle.
  if (!at_it && up > 0) made.of.start = R.transpose().leftCols(up) * draw.vector(up, 0.5, 2.0);
  return made;
}

/// x^3 - 3 x y^2 + (x^2 + y^2)^2, flat to second order where it starts.
inline Programme monkey_saddle(Draw& draw) {
  Programme made{boxed("monkey saddle", 2, 5.0, Vector::Zero(2))};
  set_rotated(
      made.of, draw.rotation(2),
      [](const Vector& y) {
        return std::pow(y[0], 3) - 3.0 * y[0] * y[1] * y[1] + std::pow(y.squaredNorm(), 2);
      },
      [](const Vector& y) {
        const double r = 4.0 * y.squaredNorm();
        return vec({3.0 * (y[0] * y[0] - y[1] * y[1]) + r * y[0], -6.0 * y[0] * y[1] + r * y[1]});
      });
  made.of.optimum = -27.0 / 256.0;
  made.change = 0.1;
  return made;
}

/// Peano's (y - x^2) (y - 2 x^2): rises along every line, falls along a parabola; with a term that
/// ends that.
inline Programme parabolas() {
  Programme made{boxed("parabolas", 2, 3.0, Vector::Zero(2))};
  made.of.f = [](const Vector& x) {
    const double a = x[0] * x[0];
    return (x[1] - a) * (x[1] - 2.0 * a) + std::pow(a, 3);
  };
  made.of.g = [](const Vector& x) {
    const double a = x[0] * x[0];
    return vec({2.0 * x[0] * (-3.0 * x[1] + 4.0 * a) + 6.0 * a * a * x[0], 2.0 * x[1] - 3.0 * a});
  };
  // With y = 3/2 a, f = -a^2 / 4 + a^3.
  made.of.optimum = -1.0 / 432.0;
  made.change = 2e-3;
  return made;
}

/// x_2 on a circle, from its highest point: a maximum that a curved constraint makes.
inline Programme circle(double radius) {
  Programme made{boxed("circle", 2, 5.0 * radius, vec({0.0, radius}))};
  made.of.f = [](const Vector& x) { return x[1]; };
  made.of.g = [](const Vector&) { return vec({0.0, 1.0}); };
  made.of.rows = 2;
  const double square = radius * radius;
  made.of.c = [square](const Vector& x) {
    const double off = x.squaredNorm() / square - 1.0;
    return vec({1e-6 + off, 1e-6 - off});
  };
  made.of.J = [square](const Vector& x) {
    Matrix J(2, 2);
    J.row(0) = 2.0 / square * x.transpose();
    J.row(1) = -J.row(0);
    return J;
  };
  made.of.optimum = -radius;
  made.change = radius;
  return made;
}

/// Sigmoids that say nothing where they start.
inline Programme plateau(Draw& draw, int n) {
  Programme made{boxed("plateau", n, 100.0, Vector::Constant(n, draw.uniform(30.0, 60.0)))};
  made.of.f = [](const Vector& x) { return (1.0 + (-x.array()).exp()).inverse().sum(); };
  made.of.g = [](const Vector& x) {
    const Eigen::ArrayXd s = (1.0 + (-x.array()).exp()).inverse();
    return Vector((s * (1.0 - s)).matrix());
  };
  return made;
}

/// sum |y_i - t_i| w_i.
inline Programme kinks(Draw& draw, int n) {
  Programme made{boxed("kinks", n, 50.0, draw.vector(n, -3.0, 3.0))};
  const Vector t = draw.vector(n, -2.0, 2.0), w = draw.vector(n, 0.3, 3.0);
  set_rotated(
      made.of, draw.rotation(n), [=](const Vector& y) { return (y - t).cwiseAbs().dot(w); },
      [=](const Vector& y) { return Vector((y - t).cwiseSign().cwiseProduct(w)); });
  return made;
}

/// sum (x_i - log x_i), not a number where x_i <= 0.
inline Programme logarithms(Draw& draw, int n) {
  Programme made{boxed("logarithms", n, 20.0, draw.vector(n, -1.0, 3.0))};
  made.of.f = [](const Vector& x) { return (x.array() - x.array().log()).sum(); };
  made.of.g = [](const Vector& x) { return Vector((1.0 - x.array().inverse()).matrix()); };
  made.of.optimum = n;
  return made;
}

/// |x - t|^2 in bounds that nobody would call bounds.
inline Programme far_bounds(Draw& draw, int n) {
  Programme made{boxed("far bounds", n, 1e9, draw.vector(n, -1000.0, 1000.0))};
  const Vector t = draw.vector(n, -5.0, 5.0);
  made.of.f = [t](const Vector& x) { return (x - t).squaredNorm(); };
  made.of.g = [t](const Vector& x) { return Vector(2.0 * (x - t)); };
  return made;
}

/// a x >= 1 and a x <= -1.
inline Programme contradiction(Draw& draw, int n) {
  Programme made{boxed("contradiction", n, 5.0, draw.vector(n, -2.0, 2.0)), false};
  const Vector a = draw.vector(n, 0.5, 1.5), b = draw.vector(n, -1.0, 1.0);
  made.of.f = [b](const Vector& x) { return b.dot(x); };
  made.of.g = [b](const Vector&) { return b; };
  Matrix A(2, n);
  A << a.transpose(), -a.transpose();
  add_rows(made.of, A, Vector::Constant(2, -1.0));
  return made;
}

/// x on a plane stated by an equality whose gradient vanishes there, (a x - 1)^power = 0, each side
/// of it within 1e-6.
inline Programme flat_equality(Draw& draw, int n, int power) {
  Programme made{boxed("flat equality", n, 5.0, Vector::Zero(n))};
  const Vector a = draw.vector(n, 0.5, 1.5);
  made.of.f = [a](const Vector& x) {
    return a.dot(x) + 0.5 * (x - a * a.dot(x) / a.squaredNorm()).squaredNorm();
  };
  made.of.g = [a](const Vector& x) { return Vector(a + x - a * a.dot(x) / a.squaredNorm()); };
  made.of.rows = 2;
  made.of.c = [a, power](const Vector& x) {
    const double h = std::pow(a.dot(x) - 1.0, power);
    return vec({1e-6 + h, 1e-6 - h});
  };
  made.of.J = [a, power](const Vector& x) {
    const double d = power * std::pow(a.dot(x) - 1.0, power - 1);
    Matrix J(2, a.size());
    J << d * a.transpose(), -d * a.transpose();
    return J;
  };
  made.of.optimum = 1.0;
  return made;
}

/// Two equalities that are none together, each within 1e-6.
inline Programme contradicting_equalities(Draw& draw, int n) {
  Programme made = contradiction(draw, n);
  made.of.name = "contradicting equalities " + std::to_string(n);
  const Matrix a = draw.vector(n, 0.5, 1.5).transpose();
  Matrix A(4, n);
  A << a, -a, 2.0 * a, -2.0 * a;
  add_rows(made.of, A, vec({1e-6, 1e-6, 1.0 + 1e-6, -1.0 + 1e-6}));
  return made;
}

/// |x - t|^2 + 1 <= 0.
inline Programme empty_ball(Draw& draw, int n) {
  Programme made = contradiction(draw, n);
  made.of.name = "empty ball " + std::to_string(n);
  const Vector t = draw.vector(n, -1.0, 1.0);
  made.of.rows = 1;
  made.of.c = [t](const Vector& x) { return Vector::Constant(1, -1.0 - (x - t).squaredNorm()); };
  made.of.J = [t](const Vector& x) { return Matrix(-2.0 * (x - t).transpose()); };
  return made;
}

/// |x|^2 >= 1 from x = 0, where no gradient says how.
inline Programme between(int n) {
  Programme made{boxed("between", n, 5.0, Vector::Zero(n))};
  made.of.f = [](const Vector& x) { return 0.5 * x.squaredNorm(); };
  made.of.g = [](const Vector& x) { return x; };
  made.of.rows = 1;
  made.of.c = [](const Vector& x) { return Vector::Constant(1, x.squaredNorm() - 1.0); };
  made.of.J = [](const Vector& x) { return Matrix(2.0 * x.transpose()); };
  made.of.optimum = 0.5;
  return made;
}

/// Several of every kind.
inline std::vector<Programme> programmes(unsigned seed) {
  Draw draw(seed);
  std::vector<Programme> all;
  const auto n = [&] { return draw.whole(1, 20); };
  const auto offset = [&](double scale) { return scale * std::pow(10.0, draw.whole(2, 6)); };
  for (int k = 0; k < 2; ++k) {
    const double scale = draw.scale();
    all.push_back(restated(bowl(draw, n()), draw.scale(), 0.0));
    all.push_back(restated(bowl(draw, n()), scale, offset(scale)));
    all.push_back(in_units(plane(draw, n()), Vector::Constant(1, draw.scale())));
    all.push_back(restated(in_units(plane(draw, n()), Vector::Constant(1, draw.scale())), scale,
                           -offset(scale)));
    all.push_back(repeated(draw, n()));
    all.push_back(restated(saddle(draw, n(), 0, true), draw.scale(), 0.0));
    const int m = draw.whole(2, 12);
    all.push_back(saddle(draw, m, draw.whole(1, m - 1), true));
    all.push_back(saddle(draw, m, draw.whole(1, m - 1), false));
    all.push_back(plateau(draw, draw.whole(1, 4)));
    all.push_back(kinks(draw, draw.whole(1, 6)));
    all.push_back(logarithms(draw, draw.whole(1, 6)));
    all.push_back(in_units(contradiction(draw, n()), Vector::Constant(2, draw.scale())));
    all.push_back(in_units(empty_ball(draw, n()), Vector::Constant(1, draw.scale())));
    all.push_back(contradicting_equalities(draw, n()));
    all.push_back(between(draw.whole(1, 6)));
    all.push_back(flat_equality(draw, draw.whole(1, 6), k == 0 ? 3 : 5));
  }
  all.push_back(restated(monkey_saddle(draw), draw.scale(), 0.0));
  all.push_back(parabolas());
  all.push_back(circle(std::pow(10.0, draw.whole(-2, 2))));
  all.push_back(far_bounds(draw, draw.whole(1, 6)));
  for (Programme& made : all) {
    // For methods that minimise sums of squares: a bound from below.
    FunctionProblem& p = made.of;
    if (!p.residuals) p.residuals = FunctionResiduals{p.optimum - 200.0 * made.change};
  }
  return all;
}

}  // namespace prospect::hostile

// SPDX-License-Identifier: Apache-2.0
#include "problems/r1.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "problems/euler_unicycle.h"
#include "problems/expression_builder.h"
#include "problems/r1_kernel.h"

namespace prospect {
namespace {

/// Coordinates by column, padded for the kernel with points far below or beside everything.
struct Columns {
  std::vector<double> x, y, down;
  std::vector<float> score_x, score_y, score_down;  // the same for scores
  int padded() const { return static_cast<int>(x.size()); }
  void finish() {
    score_x.assign(x.begin(), x.end());
    score_y.assign(y.begin(), y.end());
    score_down.assign(down.begin(), down.end());
  }
};

double draw(std::mt19937& generator, double lower, double upper) {
  return std::uniform_real_distribution<double>(lower, upper)(generator);
}

Columns draw_places(unsigned seed, int count, double x_lower, double x_upper, double y_reach) {
  std::mt19937 generator(seed);
  const auto size = static_cast<std::size_t>(R1Kernel::padded(count));
  Columns places{std::vector<double>(size, 1e3), std::vector<double>(size, 1e3), {}, {}, {}, {}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    places.x[i] = draw(generator, x_lower, x_upper);
    places.y[i] = draw(generator, -y_reach, y_reach);
  }
  places.finish();
  return places;
}

Columns draw_points() {
  constexpr double kCameraHeight = 0.5;
  constexpr std::size_t kCount = 150;
  std::mt19937 generator(11);
  const std::size_t size = R1Kernel::padded(kCount);
  Columns points{std::vector<double>(size, 0.0),
                 std::vector<double>(size, 0.0),
                 std::vector<double>(size, 1e6),
                 {},
                 {},
                 {}};
  for (std::size_t i = 0; i < kCount; ++i) {
    points.x[i] = draw(generator, 2.0, 8.0);
    points.y[i] = draw(generator, -4.0, 4.0);
    points.down[i] = kCameraHeight - draw(generator, 0.2, 2.2);
  }
  points.finish();
  return points;
}

/// A sum over the stages 1..N of a value at each pose, whose residuals are the roots of what each
/// stage is above the bound of sign times that value.
class PoseTerm : public Term {
 public:
  TermTraits traits() const override {
    return {.smoothness = Smoothness::kC0,
            .unit = "-",
            .normalisation = "sum over stages",
            .scores = true};
  }
  std::optional<ResidualForm> residual_form(const Horizon& h, int sign) const final {
    if (sign != sign_) return std::nullopt;
    ResidualForm form{h.N * bound_, h.N, {}};
    for (int k = 1; k <= h.N; ++k) form.pattern.push_back({k - 1, k, false});
    return form;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const final {
    for (int b = 0; b < t.batch(); ++b) {
      double value = 0.0;
      for (int k = 1; k <= t.horizon.N; ++k) {
        const double theta = t.yaw(k, b);
        const R1Pose pose{t.px(k, b), t.py(k, b), std::cos(theta), std::sin(theta)};
        if (request.score) {
          value += score(pose);
          continue;
        }
        const R1Value stage = at(pose, request.gradient || request.residuals != 0);
        value += stage.value;
        if (request.residuals != 0) {
          const RootResidual root(sign_ * stage.value - bound_);
          const double slope = sign_ * root.slope;
          out.residuals[k - 1] = root.value;
          out.set_pose_block(t, k - 1, slope * stage.d_px, slope * stage.d_py, 0.0,
                             slope * stage.d_theta);
        }
        if (request.gradient) {
          out.add_pose_gradient(t, k, b, stage.d_px, stage.d_py, 0.0, stage.d_theta);
        }
      }
      out.value(0, b) = value;
    }
  }

 protected:
  /// bound <= sign T at every pose.
  PoseTerm(int sign, double bound) : sign_(sign), bound_(bound) {}
  virtual R1Value at(const R1Pose& pose, bool gradient) const = 0;
  /// The value in single precision.
  virtual double score(const R1Pose& pose) const = 0;
  const int sign_;
  const double bound_;
  const R1Kernel kernel_ = r1_kernel(best_instruction_set());
};

class Collision final : public PoseTerm {
 public:
  Collision() : PoseTerm(1, 0.0) {}
  std::string_view name() const override { return "r1_collision"; }

 private:
  R1Value at(const R1Pose& pose, bool gradient) const override {
    return (gradient ? kernel_.collision_gradient : kernel_.collision)(
        pose, discs_.x.data(), discs_.y.data(), discs_.padded());
  }
  double score(const R1Pose& pose) const override {
    return kernel_.collision_score(pose, discs_.score_x.data(), discs_.score_y.data(),
                                   discs_.padded());
  }
  const Columns discs_ = draw_places(7, 12, 1.0, 5.0, 2.5);
};

class Gain final : public PoseTerm {
 public:
  Gain() : PoseTerm(-1, -kBlobs) {}
  std::string_view name() const override { return "r1_gain"; }

 private:
  R1Value at(const R1Pose& pose, bool gradient) const override {
    return (gradient ? kernel_.gain_gradient : kernel_.gain)(pose, blobs_.x.data(), blobs_.y.data(),
                                                             blobs_.padded());
  }
  double score(const R1Pose& pose) const override {
    return kernel_.gain_score(pose, blobs_.score_x.data(), blobs_.score_y.data(), blobs_.padded());
  }
  static constexpr int kBlobs = 10;
  const Columns blobs_ = draw_places(13, kBlobs, 2.0, 7.0, 4.0);
};

class Features final : public PoseTerm {
 public:
  Features() : PoseTerm(1, 0.0) {}
  std::string_view name() const override { return "r1_features"; }

 private:
  R1Value at(const R1Pose& pose, bool gradient) const override {
    R1Value n = (gradient ? kernel_.visible_gradient : kernel_.visible)(
        pose, points_.x.data(), points_.y.data(), points_.down.data(), points_.padded());
    const double e = std::exp((20.0 - n.value) / 5.0);  // at most e^4: n >= 0
    const double slope = -0.2 * e / (1.0 + e);
    return {std::log1p(e), slope * n.d_px, slope * n.d_py, slope * n.d_theta};
  }
  double score(const R1Pose& pose) const override {
    const double n = kernel_.visible_score(pose, points_.score_x.data(), points_.score_y.data(),
                                           points_.score_down.data(), points_.padded());
    return static_cast<double>(std::log1p(std::exp(static_cast<float>((20.0 - n) / 5.0))));
  }
  const Columns points_ = draw_points();
};

class Inputs final : public Term {
 public:
  std::string_view name() const override { return "r1_inputs"; }
  TermTraits traits() const override { return {.unit = "-", .normalisation = "sum over stages"}; }
  std::optional<ResidualForm> residual_form(const Horizon& h, int sign) const override {
    if (sign < 0) return std::nullopt;
    ResidualForm form{0.0, 3 * h.N, {}};
    for (int k = 0; k < h.N; ++k) {
      for (int i = 0; i < 3; ++i) form.pattern.push_back({3 * k + i, k, true});
      if (k > 0) form.pattern.push_back({3 * k + 2, k - 1, true});
    }
    return form;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      double value = 0.0, before = t.u_previous[1];
      for (int k = 0; k < t.horizon.N; ++k) {
        const double slow = t.u(k, 0, b) - 0.5, w = t.u(k, 1, b), change = w - before;
        value += 0.05 * w * w + 0.1 * slow * slow + 0.2 * change * change;
        before = w;
        if (request.residuals != 0) write_residuals(k, slow, w, change, out);
        if (!request.gradient) continue;
        out.input_gradient(2 * k, b) += 0.2 * slow;
        out.input_gradient(2 * k + 1, b) += 0.1 * w + 0.4 * change;
        if (k > 0) out.input_gradient(2 * k - 1, b) -= 0.4 * change;
      }
      out.value(0, b) = value;
    }
  }

 private:
  static void write_residuals(int k, double slow, double w, double change, TermOutput& out) {
    const double a = std::sqrt(0.2), b = std::sqrt(0.1), c = std::sqrt(0.4);
    out.residuals.segment<3>(3 * k) << a * slow, b * w, c * change;
    const int first = k == 0 ? 0 : 4 * k - 1;
    out.jacobian.middleCols(first, k == 0 ? 3 : 4).setZero();
    out.jacobian(0, first) = a;
    out.jacobian(1, first + 1) = b;
    out.jacobian(1, first + 2) = c;
    if (k > 0) out.jacobian(1, first + 3) = -c;
  }
};

}  // namespace

std::shared_ptr<const Term> make_r1_collision() { return std::make_shared<Collision>(); }
std::shared_ptr<const Term> make_r1_features() { return std::make_shared<Features>(); }
std::shared_ptr<const Term> make_r1_gain() { return std::make_shared<Gain>(); }
std::shared_ptr<const Term> make_r1_inputs() { return std::make_shared<Inputs>(); }

Problem make_r1(const Eigen::Vector3d& x0) {
  ProblemDefinition d;
  d.model = std::make_shared<EulerUnicycle>(0.7, 1.0);
  d.x0 = x0;
  d.u_previous = Eigen::Vector2d::Zero();
  d.N = d.M = 20;
  d.dt = 0.2;
  d.terms = {{make_r1_collision(), 20.0},
             {make_r1_features(), 0.5},
             {make_r1_gain(), -0.3},
             {make_r1_inputs(), 1.0}};
  return Problem(std::move(d));
}

namespace {

using Formula = ExpressionBuilder::Formula;

/// s(a) = 1 / (1 + exp(-a / unit)), which overflows nowhere.
Formula sigmoid(ExpressionBuilder& e, Formula a, double unit) {
  return 0.5 * (1.0 + e.of(Expression::Operation::kTanh, a / (2.0 * unit)));
}

/// The weighted terms of one pose.
Formula stated_pose(ExpressionBuilder& e, Formula px, Formula py, Formula theta) {
  using enum Expression::Operation;
  static const Columns discs = draw_places(7, 12, 1.0, 5.0, 2.5);
  static const Columns blobs = draw_places(13, 10, 2.0, 7.0, 4.0);
  static const Columns points = draw_points();
  const Formula cosine = e.of(kCos, theta), sine = e.of(kSin, theta);
  std::vector<Formula> collision, gain, count;
  for (std::size_t i = 0; i < 12; ++i) {
    const Formula dx = px - discs.x[i], dy = py - discs.y[i];
    const Formula distance = e.of(kSqrt, dx * dx + dy * dy + 1e-30);
    collision.push_back(0.5 * (1.0 - e.of(kTanh, 8.0 * (distance - 0.6))));
  }
  const Formula qx = px + 1.5 * cosine, qy = py + 1.5 * sine;
  for (std::size_t i = 0; i < 10; ++i) {
    const Formula dx = qx - blobs.x[i], dy = qy - blobs.y[i];
    gain.push_back(e.of(kExp, (dx * dx + dy * dy) * (-0.5 / (0.8 * 0.8))));
  }
  for (std::size_t i = 0; i < 150; ++i) {
    const Formula dx = points.x[i] - px, dy = points.y[i] - py;
    const Formula zc = cosine * dx + sine * dy, xc = sine * dx - cosine * dy;
    const Formula ahead = e.number(0.05) < zc;
    const Formula z = e.choose(ahead, zc, e.number(0.05));
    const Formula u = 450.0 * xc / z + 320.0, v = 450.0 * points.down[i] / z + 240.0;
    const Formula seen = sigmoid(e, u, 10.0) * sigmoid(e, 640.0 - u, 10.0) *
                         (sigmoid(e, v, 10.0) * sigmoid(e, 480.0 - v, 10.0)) *
                         sigmoid(e, z - 0.5, 0.1);
    count.push_back(e.choose(ahead, seen, e.number(0.0)));
  }
  const Formula missing = e.of(kLog, 1.0 + e.of(kExp, (20.0 - e.sum(count)) / 5.0));
  return 20.0 * e.sum(collision) + 0.5 * missing - 0.3 * e.sum(gain);
}

}  // namespace

StatedProgramme r1_stated(const Eigen::Vector3d& x0) {
  using enum Expression::Operation;
  const Problem problem = make_r1(x0);
  ExpressionBuilder e(problem.num_variables());
  Formula px = e.number(x0[0]), py = e.number(x0[1]), theta = e.number(x0[2]);
  Formula before = e.number(0.0);
  std::vector<Formula> cost;
  const double dt = problem.definition().dt;
  for (int k = 0; k < problem.definition().N; ++k) {
    const Formula v = e.x(2 * k), w = e.x(2 * k + 1);
    const Formula slow = v - 0.5, change = w - before;
    cost.push_back(0.05 * w * w + 0.1 * slow * slow + 0.2 * change * change);
    before = w;
    const Formula way = dt * v;
    const Formula next_x = px + way * e.of(kCos, theta);
    py = py + way * e.of(kSin, theta);
    px = next_x;
    theta = theta + dt * w;
    cost.push_back(stated_pose(e, px, py, theta));
  }
  return {"R1", r1_cold(),   problem.lower(), problem.upper(), e.finish(e.sum(cost)),
          {},   std::nullopt};
}

Eigen::VectorXd r1_cold() { return Eigen::Vector2d(0.5, 0.0).replicate(20, 1); }

std::vector<Eigen::Vector3d> r1_starts(unsigned seed, int count) {
  std::mt19937 generator(seed);
  std::vector<Eigen::Vector3d> starts(static_cast<std::size_t>(count));
  for (Eigen::Vector3d& x : starts) {
    x[0] = draw(generator, -0.5, 0.5);
    x[1] = draw(generator, -0.5, 0.5);
    x[2] = draw(generator, -0.6, 0.6);
  }
  return starts;
}

const std::array<double, 30>& s30_best_known() {
  static constexpr std::array<double, 30> best = {
      0.2849, 11.2802, 0.3779, 0.3050,  0.2195,  0.2412, 0.3148,  0.4148,  0.4639, 0.7582,
      0.7298, 0.2794,  6.4314, 10.5374, 1.3393,  0.0538, 47.2089, 11.7371, 0.4575, 0.2908,
      0.3878, 15.1194, 87.982, 0.5081,  18.2557, 3.6623, 0.4311,  2.5182,  0.3174, 0.3655};
  return best;
}

bool r1_solved(double J, double best_known) {
  return J <= best_known + std::max(0.01, 0.01 * std::abs(best_known));
}

}  // namespace prospect

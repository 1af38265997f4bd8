// SPDX-License-Identifier: Apache-2.0
#include "problems/r1.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "problems/euler_unicycle.h"
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

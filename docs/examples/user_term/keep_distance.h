// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>

#include "engine/problem/term_registry.h"

/// Keeps the robot away from a point q, a person for example, without forbidding anything:
///   T = 1/N sum_{k=1..N} exp(-|p_k - q|^2 / (2 r^2)),   p_k, q in W [m].
/// 1 while standing on the point, 0 far away. Smooth, with its exact gradient.
class KeepDistance final : public prospect::Term {
 public:
  KeepDistance(const Eigen::Vector2d& q, double r) : q_(q), r_(r) {}

  std::string_view name() const override { return "keep_distance"; }
  prospect::TermTraits traits() const override {
    return {.unit = "-", .normalisation = "mean over stages; 1 on the point"};
  }

  void evaluate(const prospect::TrajectoryBatch& t, const prospect::TermRequest& request,
                prospect::TermScratch*, prospect::TermOutput& out) const override {
    const int N = t.horizon.N;
    for (int b = 0; b < t.batch(); ++b) {
      double sum = 0.0;
      for (int k = 1; k <= N; ++k) {  // x_0 is given: nothing can be done about it
        const Eigen::Vector2d d = Eigen::Vector2d(t.px(k, b), t.py(k, b)) - q_;
        const double closeness = std::exp(-d.squaredNorm() / (2.0 * r_ * r_));
        sum += closeness;
        if (request.gradient) {
          const Eigen::Vector2d g = -closeness / (N * r_ * r_) * d;
          out.add_pose_gradient(t, k, b, g.x(), g.y(), 0.0, 0.0);
        }
      }
      out.value(0, b) = sum / N;
    }
  }

 private:
  Eigen::Vector2d q_;
  double r_;
};

/// Its options: name, default, range, unit, what it is.
inline const prospect::TermOption kKeepDistanceOptions[] = {
    {"x", 0.0, -1e4, 1e4, "m", "of the point, in W"},
    {"y", 0.0, -1e4, 1e4, "m", "of the point, in W"},
    {"radius", 0.5, 0.05, 10.0, "m", "distance at which it is down to 0.61"},
};

inline prospect::Term* make_keep_distance(const prospect::TermOptions& options,
                                          const prospect::TermContext&) {
  return new KeepDistance({options.at("x"), options.at("y")}, options.at("radius"));
}

// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/track_survival.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/knobs.h"

namespace prospect {
namespace {

// Strengths a + b that are tried, by equal ratios: below, every landmark lives for ever or not at
// all; above, all are alike.
constexpr int kStrengths = 19;
double strength_of(int i) { return std::pow(10.0, i / 6.0); }  // 1 to 1000

}  // namespace

TrackSurvival::TrackSurvival(const Options& options) : options_(options) {
  check_knobs("track survival", options);
}

void TrackSurvival::add(int found_before, bool found) {
  const auto age = static_cast<std::size_t>(std::clamp(found_before, 0, kAges - 1));
  views_[age] += 1.0;
  if (!found) lost_[age] += 1.0;
}

void TrackSurvival::add_missed(bool found) {
  missed_views_ += 1.0;
  if (found) found_again_ += 1.0;
}

void TrackSurvival::forget() {
  const double kept = 1.0 - 1.0 / options_.memory;
  for (double& x : views_) x *= kept;
  for (double& x : lost_) x *= kept;
  missed_views_ *= kept;
  found_again_ *= kept;
}

TrackSurvival::Fit TrackSurvival::fit() const {
  if (std::all_of(views_.begin(), views_.end(), [](double x) { return x <= 0.0; })) {
    return {options_.prior_loss, options_.prior_views,
            (1.0 + found_again_) / (2.0 + missed_views_)};
  }
  std::array<double, kAges> views = views_, lost = lost_;
  views[0] += options_.prior_views;
  lost[0] += options_.prior_views * options_.prior_loss;
  // Log-likelihood of b/(a+b) = loss.
  const auto likelihood = [&](double loss, double strength) {
    double sum = 0.0;
    for (int n = 0; n < kAges; ++n) {
      const auto i = static_cast<std::size_t>(n);
      if (views[i] <= 0.0) continue;
      const double q = loss * strength / (strength + n);
      sum += lost[i] * std::log(q) + (views[i] - lost[i]) * std::log1p(-q);
    }
    return sum;
  };
  Fit best;
  double highest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kStrengths; ++i) {
    const double strength = strength_of(i);
    // Concave in the loss: each q is a multiple of it. Golden section.
    constexpr double kRatio = 0.6180339887498949;
    double low = 1e-6, high = 1.0 - 1e-6;
    double left = high - kRatio * (high - low), right = low + kRatio * (high - low);
    double at_left = likelihood(left, strength), at_right = likelihood(right, strength);
    while (high - low > 1e-5) {
      if (at_left > at_right) {
        high = right;
        right = left;
        at_right = at_left;
        left = high - kRatio * (high - low);
        at_left = likelihood(left, strength);
      } else {
        low = left;
        left = right;
        at_left = at_right;
        right = low + kRatio * (high - low);
        at_right = likelihood(right, strength);
      }
    }
    const double loss = 0.5 * (low + high);
    const double value = likelihood(loss, strength);
    // Among equals the stronger one: without evidence that they are not, landmarks are alike.
    if (value >= highest) {
      highest = value;
      best.loss = loss;
      best.strength = strength;
    }
  }
  best.again = (1.0 + found_again_) / (2.0 + missed_views_);
  return best;
}

double TrackSurvival::probability(const Fit& fit, int found_before, bool missed, int views) {
  const double b = fit.loss * fit.strength;
  double p = 1.0;
  for (int j = 0; j < views; ++j) {
    p *= missed && j == 0 ? fit.again : 1.0 - b / (fit.strength + found_before + j);
  }
  return p;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "runtime/gyro_rate.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

constexpr double kTogether = 0.3;  // [s] between two samples that belong together
constexpr double kKnownAfter = 0.5, kBiasMemory = 2.0;  // [s] of standing

bool repeats(const ImuSample& one, const ImuSample& before) {
  return one.angular_velocity == before.angular_velocity &&
         one.linear_acceleration == before.linear_acceleration;
}

}  // namespace

std::optional<GyroRate::Turn> GyroRate::look(std::span<const ImuSample> samples) {
  rates_.clear();
  const std::optional<double> before = stamp();
  for (const ImuSample& sample : samples) {
    if (!std::isfinite(sample.stamp) || !sample.finite()) continue;
    if (newest_ && (!(sample.stamp > newest_->stamp) || repeats(sample, *newest_))) continue;
    newest_ = sample;
    rates_.push_back(sample.yaw_rate());
  }
  if (rates_.empty() || !before || newest_->stamp - *before > kTogether) return std::nullopt;
  const auto middle = rates_.begin() + static_cast<std::ptrdiff_t>(rates_.size() / 2);
  std::nth_element(rates_.begin(), middle, rates_.end());
  return Turn{*before, newest_->stamp, *middle - bias_};
}

void GyroRate::stood(const Turn& turn) {
  const double measured = turn.rate + bias_, dt = turn.until - turn.from;
  if (!(std::abs(measured) <= most_bias_)) return;
  stood_ = std::min(stood_ + dt, kBiasMemory);
  bias_ += (measured - bias_) * std::min(1.0, dt / stood_);
}

bool GyroRate::knows_bias() const { return stood_ >= kKnownAfter; }

std::optional<double> GyroRate::stamp() const {
  return newest_ ? std::optional(newest_->stamp) : std::nullopt;
}

}  // namespace prospect

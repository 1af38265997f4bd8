// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "models/imu_sample.h"

namespace prospect {

/// How fast a body turns by its gyro, from one look at its samples to the next.
///
///     rate = median of the samples' yaw rates - bias
///
/// so that one sample that is wrong decides nothing. What repeats the sample before in all six
/// numbers is no measurement but a sensor that hangs; what is not finite, or not newer, says
/// nothing either.
///
/// Bias. A gyro is off by a constant, which drifts with its temperature over minutes. It is the
/// mean of what it says while the robot stands, over the newest 2 s of that; until it has stood for
/// 0.5 s it is not known. What is more than `most_bias` is a turn, not a bias.
///
/// Thread-safety: one thread. Never throws. Source: our choice.
class GyroRate {
 public:
  explicit GyroRate(double most_bias) : most_bias_(most_bias) {}

  /// A mean over a time.
  struct Turn {
    double from = 0.0, until = 0.0;  ///< [s]
    double rate = 0.0;               ///< [rad/s], to the left
  };
  /// Samples that came since the look before, oldest first. None: they say nothing.
  std::optional<Turn> look(std::span<const ImuSample> samples);
  /// The robot stood over that time.
  void stood(const Turn& turn);
  bool knows_bias() const;
  /// Of the newest sample that was one [s]; none so far.
  std::optional<double> stamp() const;

 private:
  double most_bias_;  // [rad/s]
  std::optional<ImuSample> newest_;
  std::vector<double> rates_;  // of this look [rad/s]
  double bias_ = 0.0;          // [rad/s]
  double stood_ = 0.0;         // [s] that it was measured for
};

}  // namespace prospect

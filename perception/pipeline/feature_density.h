// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

namespace prospect {

class Knobs;

struct FeatureDensityOptions {
  double quantile = 0.25;  ///< of the last `window` samples
  double area = 1.0;       ///< [m^2] of new surface that makes a sample
  int window = 40;
  double initial = 5.0;  ///< [1/m^2], until there are four samples
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, FeatureDensityOptions& options);

/// How many landmarks a square metre of surface that was not seen before is likely to bear, learned
/// from the surfaces that were: a quantile of samples, each the number of new landmarks over the
/// new surface since the sample before. A pessimistic quantile, as a plan that counts on texture
/// which is not there is lost, and one that does not is slow.
/// Thread-safety: one thread. Errors: the constructor throws std::invalid_argument on an option out
/// of range.
class FeatureDensity {
 public:
  explicit FeatureDensity(const FeatureDensityOptions& options = {});

  /// new_landmarks: since the last call. surface [m^2]: all that has been mapped so far.
  void add(int new_landmarks, double surface);
  double value() const { return value_; }  ///< [1/m^2]

 private:
  FeatureDensityOptions options_;
  std::deque<double> samples_;
  double last_surface_ = 0.0;
  int new_landmarks_ = 0;
  double value_;
};

}  // namespace prospect

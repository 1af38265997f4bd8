// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace prospect {

/// Stamps of frames that come one after the other.
class FrameClock {
 public:
  /// `max_gap`: more than so many usual periods between two frames are a gap.
  explicit FrameClock(double max_gap = 2.6) : max_gap_(max_gap) {}

  /// The next frame's stamp [s]. What is wrong with it, and then it is not taken; empty: nothing.
  std::string tick(double stamp);

  double step() const { return step_; }      ///< since the frame before [s]; 0 at the first
  bool gap() const { return gap_; }          ///< between the last two frames
  double period() const { return period_; }  ///< usual time between frames [s]; 0: not known yet

 private:
  double max_gap_;
  std::optional<double> last_;
  double step_ = 0.0, period_ = 0.0;
  bool gap_ = false;
};

}  // namespace prospect

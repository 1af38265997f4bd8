// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace prospect {

/// Tells a sensor that hangs from one that stands: without noise, who stands sees the same again.
///
/// The same content again is suspicious once the sensor is elsewhere than where it was new, by more
/// than poses of one that stands err: 0.02 m or 0.02 rad, however slowly it got there. Who hangs
/// does so until there is new content.
///
/// Value type. Thread-safety: one thread. Never throws. Source: our choice.
class RepeatedContent {
 public:
  /// same: the content is that of the call before. T: the pose of the sensor in a frame that stays;
  /// none: nobody knows it, and motion counts from the next one that is known.
  bool hangs(bool same, const std::optional<Eigen::Isometry3d>& T);

 private:
  std::optional<Eigen::Isometry3d> since_;  // where the content was new
  bool hangs_ = false;
};

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// The axis of a file's own coordinates that points up.
enum class UpAxis { kX, kY, kZ };

/// From such coordinates to ones with z up: y up by (x, y, z) -> (x, -z, y), x up by (x, y, z) ->
/// (-y, -z, x).
inline Eigen::Matrix3d upright(UpAxis up) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (up == UpAxis::kY) R << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (up == UpAxis::kX) R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return R;
}

}  // namespace prospect

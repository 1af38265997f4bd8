// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

/// Where the right image of a rectified pair shows a patch of the left one, and how the disparity
/// changes over the patch.
struct SlantedPatch {
  Eigen::Vector2f right = Eigen::Vector2f::Zero();  ///< of the patch's centre [px]
  /// g = (dd/du, dd/dv) of the disparity d = u_left - u_right over the left image [px/px]. That of
  /// a plane is the same everywhere, as its inverse depth is linear in (u, v). Of a floor that is
  /// seen from the height h with the baseline b it is (0, b/h).
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();

  /// M: an offset x of the left image is M x in the right one, if the slope is g.
  static Eigen::Matrix2f shear(const Eigen::Vector2f& slope) {
    Eigen::Matrix2f M;
    M << 1.0f - slope.x(), -slope.y(), 0.0f, 1.0f;
    return M;
  }
};

/// Aligns the square patch of Patch (patch_alignment.h) around `centre` of the left image with the
/// right image, from `start` [px] and no slope. With its weights w, samples T of the left image and
/// I of the right one, gain and offset,
///   I(right + M x) = (1 + alpha) T(x + delta + (e . x, 0)) + beta,
/// linear in (delta, e, alpha, beta), solved for again and again until delta and e vanish, both
/// moved into `right` and g (inverse compositional alignment, as in Patch).
///
/// What the texture does not tell of the slope stays zero: g is drawn to zero as by a measurement
/// of standard deviation 0.3 px/px. Against it the residuals of grey levels count by their mean
/// square `residual` [grey^2], with ten neighbouring pixels for one, as they err alike.
///
/// Empty if the patch leaves an image, if it moves farther than max_shift [px] from the start, if
/// the brightness inverts, or if it does not settle. Deterministic; no state.
std::optional<SlantedPatch> align_slanted(const PyramidLevel& left, const Eigen::Vector2f& centre,
                                          const PyramidLevel& right, const Eigen::Vector2f& start,
                                          float residual, float max_shift);

}  // namespace prospect

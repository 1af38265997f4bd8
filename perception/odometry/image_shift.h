// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

/// By how much the picture has moved from one image to another as a whole: (du, dv) such that pixel
/// (u, v) of `from` is seen near (u + du, v + dv) of `to`, in pixels of these images.
///
/// Meant for the coarsest level of pyramids, tens of pixels wide: it is compared at every shift of
/// up to 45 % of its width and 30 % of its height by normalised correlation of what overlaps; the
/// best shift, if its correlation is at least min_correlation. Good to a pixel: a start for
/// tracking after a fast turn, which shifts near and distant things alike (Klein and Murray 2008).
/// Empty, too, if the sizes differ. Deterministic; no state.
///
/// `part`: of `from`, row by row, the pixels that count; empty: all.
std::optional<Eigen::Vector2d> image_shift(const PyramidLevel& from, const PyramidLevel& to,
                                           double min_correlation = 0.4,
                                           const std::vector<char>& part = {});

}  // namespace prospect

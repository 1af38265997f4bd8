// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/image.h"

namespace prospect {

class Knobs;

struct CornerDetectorOptions {
  /// Cells that the image is divided into, about: cells are squares of side sqrt(width height / n).
  int cells = 300;
  /// Floor of the corner strength, the smaller eigenvalue of the mean of grad I grad I^T over 7 x 7
  /// pixels [grey^2/px^2], over the variance of the image's noise (image_noise.h) [grey^2]: the
  /// same corners in a darker image. Noise alone makes less than 0.5.
  double min_strength_over_noise = 0.6;
  int border = 10;  ///< [px] without corners along the image's edges
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CornerDetectorOptions& options);

/// At most one corner a cell (Shi and Tomasi 1994): the strongest local maximum of the strength
/// that is at least half a cell away from every point of `occupied` and from every corner already
/// taken from an earlier cell. Cells that hold an occupied point are left alone, so features stay
/// spread over the image. Corners are whole pixels, in the order of cells.
/// Throws std::invalid_argument for an empty image. Deterministic; no state.
std::vector<Eigen::Vector2f> detect_corners(const ImageView& image,
                                            const std::vector<Eigen::Vector2f>& occupied = {},
                                            const CornerDetectorOptions& options = {});

/// Side [px] of the cells of an image.
double corner_cell(int width, int height, const CornerDetectorOptions& options);

}  // namespace prospect

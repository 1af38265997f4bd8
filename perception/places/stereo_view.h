// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "models/camera.h"
#include "models/image.h"

namespace prospect {

/// Bits of an ORB descriptor.
using ViewDescriptor = std::array<std::uint64_t, 4>;

/// Bits in which two descriptors differ, 0 to 256. Of unrelated patches about 128.
int distance(const ViewDescriptor& a, const ViewDescriptor& b);

struct StereoView;
/// Likewise from one to all of a view's points, `bits` of as many.
void distances(const ViewDescriptor& of, const StereoView& to, std::int16_t* bits);

/// What a stereo pair shows that can be known again, from elsewhere and much later: corners of the
/// left image at several scales, each with a descriptor that turns with the image, and its
/// disparity where the right image has it.
///
/// Source: ORB (Rublee et al. 2011) as in OpenCV. A value; thread-safe to read.
struct StereoView {
  struct Point {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< in the left image [px]
    double scale = 1.0;                               ///< pixels that one of its level covers
    double disparity = std::numeric_limits<double>::quiet_NaN();  ///< [px]; NaN: none
    double sigma_disparity = 0.0;                                 ///< [px]
    ViewDescriptor descriptor = {};

    bool has_depth() const { return disparity > 0.0; }
  };
  std::vector<Point> points;
};

struct StereoViewOptions {
  int corners = 400;    ///< at most
  int levels = 6;       ///< of the pyramid
  double factor = 1.2;  ///< by which each is coarser than the one before
  /// Least difference in grey of a corner (FAST): low, as the best are taken by Harris' measure.
  int least_contrast = 8;
  double max_disparity = 0.15;  ///< share of the image's width
  double distinctness = 1.15;   ///< of a place in the right image, by its differences in grey
  double max_row_error = 1.5;   ///< [px]
  /// Times the variance that the grey levels leave to a disparity (patch_alignment.h), as that of
  /// the odometry's landmarks.
  double texture_noise = 10.0;
};

/// Of one rectified pair of the camera's size; without points where there is no texture. Throws
/// std::invalid_argument for images of another size. Deterministic.
StereoView stereo_view(const StereoCamera& camera, const ImageView& left, const ImageView& right,
                       const StereoViewOptions& options = {});

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/depth_source.h"
#include "models/camera.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// How many numbers of a depth image are a metre, and how that is known.
struct DepthScale {
  double per_metre = 1000.0;
  std::string note;       ///< in words, one line
  bool doubtful = false;  ///< what is known contradicts it
  bool w_first = false;   ///< the poses' quaternions have w first, and are to be read again so
};

/// Chooses the scale of a recording's images: the one that is given; else, of the layout's rule,
/// 1000 and 5000 (and for floats 1), the one that what is known says clearly:
///   poses that move    the depths of one image, moved to where another was taken, lie on that
///                      one's; of a wrong scale they miss by what the camera moved. Of poses whose
///                      quaternions may have w first both orders are tried
///   camera's height    the ground is there (ground_plane.h), to 0.15 m
/// and where neither tells, the layout's. The note says which it was, and with what.
/// The metre of depths that were measured by stereo is that of the baseline; the poses are held
/// against it.
/// `read`: the numbers of image i, unscaled; where that throws InputError the image is left out.
/// Throws InputError if that is more than half of those looked at. Deterministic.
DepthScale choose_depth_scale(const DepthSource& source, const DepthDatasetOptions& options,
                              const PinholeCamera& camera,
                              const std::function<RawImage(std::size_t)>& read);

/// The depths of an image of 16 bits or of floats; empty for another kind.
DepthImage scaled_depth(const RawImage& raw, double per_metre, const DepthRange& range);

}  // namespace prospect

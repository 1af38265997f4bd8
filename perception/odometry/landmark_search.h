// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <future>
#include <memory>
#include <vector>

#include "models/image.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/odometry/track.h"

namespace prospect {

/// New landmarks on their way: corners of a keyframe's image where it has no landmark yet, and
/// where the right image has them. The search may run on a thread of its own: it has images that
/// nobody changes any more, and changes nothing.
class LandmarkSearch {
 public:
  /// `anchor`: the keyframe; `coarse`: the coarsest level of its left image, kept for whoever asks;
  /// `left`, `right`: its images, the left one as it came. `occupied` [px]: where landmarks are. On
  /// a second thread if `in_background` and one is to be had, else in found().
  LandmarkSearch(std::shared_ptr<const Anchor> anchor, PyramidLevel coarse,
                 std::shared_ptr<const Image> left, std::shared_ptr<const ImagePyramid> right,
                 std::vector<Eigen::Vector2f> occupied, const StereoOdometryOptions& options,
                 bool in_background);

  /// Whether a second thread has come to its end.
  bool ready() const;

  struct Found {
    std::vector<Eigen::Vector2f> corners;  ///< [px]
    std::vector<StereoMatch> matches;      ///< of them
  };
  /// Waits for the search. Once only. Nothing is found if there is no memory.
  Found found();

  const std::shared_ptr<const Anchor>& anchor() const { return anchor_; }
  const PyramidLevel& coarse() const { return coarse_; }

 private:
  std::shared_ptr<const Anchor> anchor_;
  PyramidLevel coarse_;
  std::future<Found> found_;
};

}  // namespace prospect

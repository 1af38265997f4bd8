// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/landmark_search.h"

#include <chrono>
#include <exception>
#include <utility>

#include "perception/odometry/corner_detector.h"
#include "perception/odometry/stereo_matcher.h"

namespace prospect {

LandmarkSearch::LandmarkSearch(std::shared_ptr<const Anchor> anchor, PyramidLevel coarse,
                               std::shared_ptr<const Image> left,
                               std::shared_ptr<const ImagePyramid> right,
                               std::vector<Eigen::Vector2f> occupied,
                               const StereoOdometryOptions& options, bool in_background)
    : anchor_(std::move(anchor)), coarse_(std::move(coarse)) {
  const auto find = [anchor = anchor_, image = std::move(left), right = std::move(right),
                     occupied = std::move(occupied), corners = options.corners,
                     matching = options.matching] {
    Found found;
    found.corners = detect_corners(image->view(), occupied, corners);
    found.matches = match_stereo(anchor->left, *right, found.corners, matching);
    return found;
  };
  if (in_background) {
    try {
      found_ = std::async(std::launch::async, find);
      return;
    } catch (const std::exception&) {
      // No thread is to be had: in this one, then.
    }
  }
  found_ = std::async(std::launch::deferred, find);
}

bool LandmarkSearch::ready() const {
  return found_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

LandmarkSearch::Found LandmarkSearch::found() {
  try {
    return found_.get();
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace prospect

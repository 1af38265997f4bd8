// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "models/image.h"

namespace prospect {

/// How well a pair of images fits being a rectified left and right one.
struct StereoCheck {
  int corners = 0;          ///< that matches were sought for, in the left image
  int matches = 0;          ///< as given
  int matches_swapped = 0;  ///< with the images exchanged (corners of the right one)
  int row_shift = 0;  ///< [px] by which the right image's rows should be moved up to match best
  int matches_shifted = 0;  ///< with that shift
  double row_error = 0.0;   ///< median over the matches as given [px]
};

/// Counts matches (stereo_matcher.h) as given, exchanged, and, if fewer than half of the corners
/// match as given, with the right image shifted by up to max_shift rows either way. Throws
/// std::invalid_argument for empty images or different sizes.
StereoCheck check_stereo(const ImageView& left, const ImageView& right, int max_shift = 16);

/// Empty, or in words what is wrong with the pair. Too little texture says nothing: empty, too.
std::string stereo_complaint(const StereoCheck& check);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/image_stream.h"

namespace prospect {

/// Which image of the right camera belongs to which of the left one.
struct FramePairs {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< left, right; increasing
  int left_alone = 0, right_alone = 0;                     ///< images without a partner
  /// Of those alone: neither before the other camera began or after it ended, nor explained by one
  /// camera being slower.
  int holes = 0;
  std::string first_hole;             ///< name of the first image alone between others
  int left_rate = 1, right_rate = 1;  ///< of one camera in those of the other: 1 and 1, 2 and 1...
  double tolerance = 0.0;             ///< [s]
  double offset = 0.0;                ///< right less left, median over the pairs [s]
  double largest_offset = 0.0;        ///< by absolute value [s]
  /// Right less left of the nearest images, median; what there is to say where nothing pairs [s].
  double nearest_offset = 0.0;
};

/// Pairs the images of two cameras whose stamps are nearest to each other both ways and at most
/// `tolerance` [s] apart; by default a tenth of the faster camera's period. One camera may be
/// slower by a whole factor.
FramePairs pair_frames(const ImageStream& left, const ImageStream& right,
                       const std::optional<double>& tolerance = {});

/// Empty, or what forbids to use the pairs, as a line for InputError: none at all, or holes in more
/// than a fifth of what should be pairs.
std::string pairing_problem(const FramePairs& pairs, const ImageStream& left,
                            const ImageStream& right);
/// What is to be said of pairs that are good: images alone, a slower camera, stamps that differ.
std::vector<std::string> pairing_notes(const FramePairs& pairs, const ImageStream& left,
                                       const ImageStream& right);

}  // namespace prospect

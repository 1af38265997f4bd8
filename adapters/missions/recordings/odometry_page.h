// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/recordings/odometry_loops.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/views/page/landmark_picture.h"

namespace prospect {

/// One self-contained HTML page that works offline: the path from above, estimated and true; images
/// with the landmarks on them; errors, standard deviations and counts over time; how reliable the
/// predictions are, if that was looked at; the path straightened by loops, and where they are, if
/// there are any. A slider leads through the frames.
///
/// Images are at most 640 px wide, JPEG, and so few (`max_images`, evenly spread) that a page takes
/// about 2 MB whatever the recording. No wall-clock times: the same recording gives the same bytes.
class OdometryPage {
 public:
  /// For a run of so many frames. Throws std::invalid_argument for less than one frame or image.
  explicit OdometryPage(int frames, int max_images = 40);

  /// After each frame.
  void add(const OdometryStep& step);

  /// `summary`: what `prospect odometry` writes as JSON, without its times ("ms"), with
  /// "calibration" if there is one. `loops`: what they made of the path, to be shown beside it.
  std::string html(const nlohmann::ordered_json& summary,
                   const OdometryLoopsResult* loops = nullptr) const;

 private:
  int every_;  ///< so many frames there is a picture
  std::vector<OdometryFrame> frames_;
  std::vector<std::optional<Eigen::Isometry3d>> truths_;
  std::vector<LandmarkPicture> pictures_;
};

}  // namespace prospect

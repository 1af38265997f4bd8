// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/depth_source.h"

#include <filesystem>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/matrix_file.h"
#include "adapters/formats/datasets/stereo_calibration.h"

namespace prospect {
namespace {

PinholeCamera read_intrinsics_file(const std::string& path) {
  const Eigen::MatrixXd K = read_matrix(path, 3, 3, "intrinsics, 3 rows of 3 numbers");
  if (!(K(0, 0) > 0.0 && K(1, 1) > 0.0) || K(0, 1) != 0.0 || K(1, 0) != 0.0 || K(2, 0) != 0.0 ||
      K(2, 1) != 0.0 || K(2, 2) != 1.0) {
    throw InputError(path + ": not of the form [fx 0 cx; 0 fy cy; 0 0 1]; expected intrinsics");
  }
  return {K(0, 0), K(1, 1), K(0, 2), K(1, 2), 0.0, 0.0};
}

/// Intrinsics that are given, or lie beside the images.
void find_intrinsics(const std::string& path, const DepthDatasetOptions& options,
                     DepthSource& source) {
  namespace fs = std::filesystem;
  const std::string beside = path + "/camera-intrinsics.txt";
  if (!options.calibration.empty()) {
    source.camera_from = options.calibration;
    source.camera = read_camera_info_pinhole(options.calibration, source.notes);
  } else if (fs::exists(beside)) {
    if (options.camera) {
      throw InputError(beside + ": states the intrinsics; expected no others beside it");
    }
    source.camera_from = beside;
    source.camera = read_intrinsics_file(beside);
  } else if (options.camera) {
    source.camera = options.camera;
    source.camera->width = source.camera->height = 0.0;
    source.camera_from = path;
  } else if (fs::exists(path + "/camera_info.yaml")) {
    source.camera_from = path + "/camera_info.yaml";
    source.camera = read_camera_info_pinhole(source.camera_from, source.notes);
  } else if (!source.camera) {
    throw InputError(path +
                     ": no file states the camera's intrinsics; expected camera-intrinsics.txt "
                     "(fx 0 cx, 0 fy cy, 0 0 1, a row a line), or --camera FX FY CX CY");
  }
}

}  // namespace

const std::vector<DepthLayout>& depth_layouts() {
  static const std::vector<DepthLayout> layouts = {
      {"ROS 2 bag", "a .mcap or .db3 file (ROS 2 bag)", is_bag, open_depth_bag},
      {"TUM RGB-D", "depth.txt (TUM RGB-D)", is_tum_rgbd, open_tum_rgbd},
      {"7-Scenes", "frame-NNNNNN.depth.png (7-Scenes)", is_seven_scenes, open_seven_scenes},
      {"numbered", "a folder depth with numbered images", is_numbered_depth, open_numbered_depth},
  };
  return layouts;
}

const DepthLayout* find_depth_layout(const std::string& path) {
  return find_layout(depth_layouts(), path);
}

DepthSource open_depth_source(const std::string& path, const DepthDatasetOptions& options) {
  std::error_code error;
  const DepthLayout* layout = find_depth_layout(path);
  if (layout == nullptr) {
    const std::string known =
        looked_for(depth_layouts(), ", ") + ", or a stereo pair, as for `prospect odometry`";
    throw InputError(path +
                     (std::filesystem::exists(path, error)
                          ? ": no recording of depth images is there; looked for " + known +
                                "; expected one of these"
                          : ": no such folder; expected a recording of depth images: " + known));
  }
  DepthSource source = layout->open(path, options);
  source.attempt([&] { find_intrinsics(path, options, source); });
  return source;
}

}  // namespace prospect

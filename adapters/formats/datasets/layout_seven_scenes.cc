// SPDX-License-Identifier: Apache-2.0
// frame-NNNNNN.depth.png and frame-NNNNNN.pose.txt.

#include <filesystem>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/matrix_file.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {
namespace {

constexpr double kSevenScenesRate = 30.0;  // [Hz]

Eigen::Matrix4d read_frame_matrix(const std::string& path) {
  const Eigen::Matrix4d M =
      read_matrix(path, 4, 4, "a pose, 4 rows of 4 numbers, camera to world", false);
  if (M.allFinite() && (M.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 1e-6) {
    throw InputError(path + ": not a rotation and translation; expected a pose, camera to world");
  }
  return M;
}

}  // namespace

bool is_seven_scenes(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    if (entry.path().filename().string().ends_with(".depth.png")) return true;
  }
  return false;
}

DepthSource open_seven_scenes(const std::string& path, const DepthDatasetOptions&) {
  DepthSource source;
  source.layout = "7-Scenes";
  source.times_assumed = true;
  source.notes.push_back("no times: 30 a second assumed");
  source.attempt([&] {
    std::string first_without;
    std::vector<double> stamps;
    std::vector<std::string> images;
    // ScanNet writes -inf for poses that are not known.
    Elements poses("poses");
    for (const auto& [n, image] : numbered_files(path, "frame-", ".depth.png")) {
      const std::string pose =
          image.substr(0, image.size() - std::string("depth.png").size()) + "pose.txt";
      if (std::filesystem::exists(pose)) {
        const Eigen::Matrix4d M = read_frame_matrix(pose);
        if (!poses.read([&] {
              source.poses.push_back(checked_pose(M.topRightCorner<3, 1>(),
                                                  Eigen::Matrix3d(M.topLeftCorner<3, 3>()), pose));
            })) {
          ++source.without_pose;
          continue;
        }
      } else if (first_without.empty()) {
        first_without = pose;
      }
      images.push_back(image);
      stamps.push_back(static_cast<double>(n) / kSevenScenesRate);
    }
    if (images.empty()) {
      throw InputError(path + ": no frame has a finite pose; expected at least one");
    }
    poses.finish(source.notes);
    if ((!source.poses.empty() || source.without_pose > 0) && !first_without.empty()) {
      throw InputError(first_without +
                       ": no such file, but other frames have a pose; expected one "
                       "for each, or none");
    }
    source.images = image_files(path, std::move(stamps), std::move(images));
  });
  return source;
}

}  // namespace prospect

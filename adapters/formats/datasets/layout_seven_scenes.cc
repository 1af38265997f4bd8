// frame-NNNNNN.depth.png and frame-NNNNNN.pose.txt.

#include <Eigen/LU>
#include <filesystem>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/matrix_file.h"
#include "adapters/formats/datasets/numbered_files.h"

namespace prospect {
namespace {

constexpr double kSevenScenesRate = 30.0;  // [Hz]

/// None: every number of the rotation and translation is not finite, as ScanNet marks frames whose
/// pose is not known.
std::optional<Eigen::Isometry3d> read_frame_pose(const std::string& path) {
  const std::string expected = "a pose, 4 rows of 4 numbers, camera to world";
  const Eigen::Matrix4d any = read_matrix(path, 4, 4, expected, false);
  if (!any.topRows<3>().array().isFinite().any()) return std::nullopt;
  const Eigen::Matrix4d M = read_matrix(path, 4, 4, expected);
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0 ||
      (M.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 1e-6) {
    throw InputError(path + ": not a rotation and translation; expected a pose, camera to world");
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  T.translation() = M.topRightCorner<3, 1>();
  return T;
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
    for (const auto& [n, image] : numbered_files(path, "frame-", ".depth.png")) {
      const std::string pose =
          image.substr(0, image.size() - std::string("depth.png").size()) + "pose.txt";
      if (std::filesystem::exists(pose)) {
        const auto T = read_frame_pose(pose);
        if (!T) {
          ++source.without_pose;
          continue;
        }
        source.poses.push_back(*T);
      } else if (first_without.empty()) {
        first_without = pose;
      }
      images.push_back(image);
      stamps.push_back(static_cast<double>(n) / kSevenScenesRate);
    }
    if (source.without_pose > 0) {
      source.notes.push_back(std::to_string(source.without_pose) +
                             " frames left out whose pose is not finite");
    }
    if (images.empty()) {
      throw InputError(path + ": no frame has a finite pose; expected at least one");
    }
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

#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace prospect {

/// A pose with its time: T maps coordinates of the moving frame to those of the fixed one.
struct TimedPose {
  double stamp = 0.0;  ///< [s]
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
};
using Trajectory = std::vector<TimedPose>;

/// The pose at a time, of stamps that increase: interpolated (linearly, and along the geodesic)
/// between neighbours that are at most max_gap [s] apart. None outside.
std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, double stamp,
                                         double max_gap);

/// TUM format: `stamp tx ty tz qx qy qz qw` a line, [s] and [m]; lines that begin with # and empty
/// ones are skipped. Throws InputError (`file:line: what; expected what`) for a missing file, a
/// line that is not eight finite numbers, a quaternion whose norm is off by more than 0.01, stamps
/// that do not increase, or a file without poses.
Trajectory read_tum_trajectory(const std::string& path);

/// KITTI format: twelve numbers a line, the upper three rows of T by rows; line i has stamps[i].
/// More poses than stamps are ignored. Throws InputError as above, also for a matrix that is no
/// rotation to 0.01, and for fewer poses than stamps.
Trajectory read_kitti_trajectory(const std::string& path, const std::vector<double>& stamps);

std::string tum_text(const Trajectory& trajectory);
std::string kitti_text(const Trajectory& trajectory);

/// All numbers of one line, separated by spaces, commas or tabs: whole tokens, independent of the
/// locale. False if a token is no finite number.
bool parse_numbers(const std::string& line, std::vector<double>& numbers);

}  // namespace prospect

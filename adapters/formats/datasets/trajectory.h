// SPDX-License-Identifier: Apache-2.0
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

/// The pose of a position and a quaternion that may be off unit length by 0.01, or of a matrix that
/// may be off a rotation by as much. Throws InputError, `where: not a pose; ...`, of others, as
/// filters and trackers write where they know none: zeros, NaN, infinities, and of places more than
/// 100000 km off.
Eigen::Isometry3d checked_pose(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
                               const std::string& where);
Eigen::Isometry3d checked_pose(const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation,
                               const std::string& where);

/// Stands in a trajectory for a pose that is not known: all NaN.
Eigen::Isometry3d unknown_pose();
bool is_known(const Eigen::Isometry3d& T);

/// The pose at a time, of stamps that increase: interpolated (linearly, and along the geodesic)
/// between neighbours that are known and at most max_gap [s] apart. None outside.
std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, double stamp,
                                         double max_gap);

/// Whether w stands before x in the quaternions of a table, by the names of its columns (qw, q_w,
/// q_RS_w []; qx and the like); none: the line does not name both.
std::optional<bool> names_w_first(const std::string& line);

/// A pose whose quaternion was read with w last though it has w first, read again.
Eigen::Isometry3d with_w_first(const Eigen::Isometry3d& T);

/// TUM format: `stamp tx ty tz qx qy qz qw` a line, [s] and [m]; or with qw before qx if a line
/// that begins with # names them so, which `notes` say. Other lines with # and empty ones are
/// skipped. What is no pose (checked_pose()) is left out and told in `notes` (elements.h). Throws
/// InputError
/// (`file:line: what; expected what`) for a missing file, a line that is not eight numbers, stamps
/// that do not increase, or a file without poses.
Trajectory read_tum_trajectory(const std::string& path, std::vector<std::string>& notes);

/// KITTI format: twelve numbers a line, the upper three rows of T by rows. Lines that are no pose
/// are unknown_pose(), counted and told likewise. Throws InputError as above.
std::vector<Eigen::Isometry3d> read_kitti_poses(const std::string& path,
                                                std::vector<std::string>& notes);

std::string tum_text(const Trajectory& trajectory);
std::string kitti_text(const Trajectory& trajectory);

/// All numbers of one line, separated by spaces, commas or tabs: whole tokens, independent of the
/// locale. False if a token is no finite number; `parse_any_numbers` takes inf and nan as well.
bool parse_numbers(const std::string& line, std::vector<double>& numbers);
bool parse_any_numbers(const std::string& line, std::vector<double>& numbers);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/trajectory.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/files/input_error.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

std::string at(const std::string& path, int line) { return path + ":" + std::to_string(line); }

Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized();
}

void check_order(const Trajectory& trajectory, double stamp, const std::string& where) {
  if (!trajectory.empty() && !(stamp > trajectory.back().stamp)) {
    throw InputError(where + ": the stamp does not increase; expected increasing stamps");
  }
}

/// Sums and products of a position that is finite, but of no place, are not.
void check_place(const Eigen::Vector3d& position, const std::string& where) {
  constexpr double kFarthest = 1e8;  // [m]: the earth's centre is 6.4e6 off, northings of UTM 1e7
  if (position.cwiseAbs().maxCoeff() <= kFarthest) return;
  throw InputError(where + ": not a pose; expected a place within 100000 km");
}

}  // namespace

Eigen::Isometry3d checked_pose(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
                               const std::string& where) {
  if (!(std::abs(rotation.norm() - 1.0) < 0.01) || !position.allFinite()) {
    throw InputError(where + ": not a pose; expected finite numbers and a unit quaternion");
  }
  check_place(position, where);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation.normalized().toRotationMatrix();
  T.translation() = position;
  return T;
}

Eigen::Isometry3d checked_pose(const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation,
                               const std::string& where) {
  if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.01) ||
      rotation.determinant() < 0.0 || !position.allFinite()) {
    throw InputError(where + ": not a pose; expected finite numbers and a rotation");
  }
  check_place(position, where);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = nearest_rotation(rotation).toRotationMatrix();
  T.translation() = position;
  return T;
}

Eigen::Isometry3d unknown_pose() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.affine().setConstant(std::numeric_limits<double>::quiet_NaN());
  return T;
}

bool is_known(const Eigen::Isometry3d& T) { return T.matrix().allFinite(); }

std::optional<bool> names_w_first(const std::string& line) {
  std::string text = lower_case(line);
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return !std::isalnum(static_cast<unsigned char>(c)) && c != '_'; }, ' ');
  std::istringstream words(text);
  std::optional<int> w, x;
  int n = 0;
  for (std::string word; words >> word; ++n) {
    if (word.find('q') == std::string::npos) continue;
    if (word.ends_with('w')) w = n;
    if (word.ends_with('x')) x = n;
  }
  if (!w || !x) return std::nullopt;
  return *w < *x;
}

Eigen::Isometry3d with_w_first(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q = nearest_rotation(T.linear());
  Eigen::Isometry3d out = T;
  out.linear() = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
  return out;
}

bool parse_any_numbers(const std::string& line, std::vector<double>& numbers) {
  numbers.clear();
  const char* p = line.data();
  const char* const end = p + line.size();
  const auto separator = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; };
  while (true) {
    while (p < end && separator(*p)) ++p;
    if (p == end) return true;
    double value = 0.0;
    const auto [next, error] = std::from_chars(p, end, value);
    if (error != std::errc() || (next != end && !separator(*next))) return false;
    numbers.push_back(value);
    p = next;
  }
}

bool parse_numbers(const std::string& line, std::vector<double>& numbers) {
  return parse_any_numbers(line, numbers) &&
         std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
}

Trajectory read_tum_trajectory(const std::string& path, std::vector<std::string>& notes) {
  std::istringstream file(read_whole_file(path));
  Trajectory trajectory;
  Elements poses("poses of " + path);
  bool w_first = false;
  std::string line;
  std::vector<double> n;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") {
      w_first = names_w_first(line).value_or(w_first);
      continue;
    }
    const std::string where = at(path, number);
    if (!parse_any_numbers(line, n) || n.size() != 8 || !std::isfinite(n[0])) {
      throw InputError(where + ": not a pose; expected stamp tx ty tz qx qy qz qw");
    }
    check_order(trajectory, n[0], where);
    poses.read([&] {
      const Eigen::Quaterniond q = w_first ? Eigen::Quaterniond(n[4], n[5], n[6], n[7])
                                           : Eigen::Quaterniond(n[7], n[4], n[5], n[6]);
      trajectory.push_back({n[0], checked_pose({n[1], n[2], n[3]}, q, where)});
    });
  }
  poses.finish(notes);
  if (trajectory.empty()) throw InputError(path + ": holds no pose; expected at least one");
  if (w_first) notes.push_back(path + ": its quaternions have w first, as its header says");
  return trajectory;
}

std::vector<Eigen::Isometry3d> read_kitti_poses(const std::string& path,
                                                std::vector<std::string>& notes) {
  std::istringstream file(read_whole_file(path));
  std::vector<Eigen::Isometry3d> out;
  Elements poses("poses of " + path);
  std::string line;
  std::vector<double> n;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line == "\r") continue;
    const std::string where = at(path, number);
    if (!parse_any_numbers(line, n) || n.size() != 12) {
      throw InputError(where + ": not a pose; expected twelve numbers");
    }
    Eigen::Matrix3d R;
    R << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
    out.push_back(unknown_pose());
    poses.read([&] { out.back() = checked_pose({n[3], n[7], n[11]}, R, where); });
  }
  poses.finish(notes);
  return out;
}

std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, double stamp,
                                         double max_gap) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                       [](const TimedPose& pose, double time) { return pose.stamp < time; });
  if (after == trajectory.end() || !is_known(after->T)) return std::nullopt;
  if (after->stamp == stamp) return after->T;
  if (after == trajectory.begin() || !is_known((after - 1)->T)) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->stamp - before->stamp;
  if (gap > max_gap) return std::nullopt;
  const double s = (stamp - before->stamp) / gap;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(before->T.linear())
                   .slerp(s, Eigen::Quaterniond(after->T.linear()))
                   .toRotationMatrix();
  T.translation() = (1.0 - s) * before->T.translation() + s * after->T.translation();
  return T;
}

std::string tum_text(const Trajectory& trajectory) {
  std::string text;
  char line[256];
  for (const TimedPose& p : trajectory) {
    const Eigen::Vector3d t = p.T.translation();
    const Eigen::Quaterniond q = nearest_rotation(p.T.linear());
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", p.stamp, t.x(),
                  t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  return text;
}

std::string kitti_text(const Trajectory& trajectory) {
  std::string text;
  char number[32];
  for (const TimedPose& p : trajectory) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) {
        std::snprintf(number, sizeof number, "%.9e%s", p.T.matrix()(r, c),
                      r == 2 && c == 3 ? "\n" : " ");
        text += number;
      }
    }
  }
  return text;
}

}  // namespace prospect

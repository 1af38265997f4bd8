#include "adapters/formats/datasets/trajectory.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

std::ifstream open(const std::string& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw InputError(path + ": cannot be read; expected a trajectory file");
  }
  return file;
}

std::string at(const std::string& path, int line) { return path + ":" + std::to_string(line); }

Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized();
}

void check_order(const Trajectory& trajectory, double stamp, const std::string& where) {
  if (!trajectory.empty() && !(stamp > trajectory.back().stamp)) {
    throw InputError(where + ": the stamp does not increase; expected increasing stamps");
  }
}

}  // namespace

bool parse_numbers(const std::string& line, std::vector<double>& numbers) {
  numbers.clear();
  const char* p = line.data();
  const char* const end = p + line.size();
  const auto separator = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; };
  while (true) {
    while (p < end && separator(*p)) ++p;
    if (p == end) return true;
    double value = 0.0;
    const auto [next, error] = std::from_chars(p, end, value);
    if (error != std::errc() || (next != end && !separator(*next)) || !std::isfinite(value)) {
      return false;
    }
    numbers.push_back(value);
    p = next;
  }
}

Trajectory read_tum_trajectory(const std::string& path) {
  std::ifstream file = open(path);
  Trajectory trajectory;
  std::string line;
  std::vector<double> n;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    const std::string where = at(path, number);
    if (!parse_numbers(line, n) || n.size() != 8) {
      throw InputError(where + ": not a pose; expected stamp tx ty tz qx qy qz qw");
    }
    const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
    if (std::abs(q.norm() - 1.0) > 0.01) {
      throw InputError(where + ": the quaternion's norm is " + std::to_string(q.norm()) +
                       "; expected 1");
    }
    check_order(trajectory, n[0], where);
    TimedPose pose{n[0], Eigen::Isometry3d::Identity()};
    pose.T.linear() = q.normalized().toRotationMatrix();
    pose.T.translation() << n[1], n[2], n[3];
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) throw InputError(path + ": holds no pose; expected at least one");
  return trajectory;
}

Trajectory read_kitti_trajectory(const std::string& path, const std::vector<double>& stamps) {
  std::ifstream file = open(path);
  Trajectory trajectory;
  std::string line;
  std::vector<double> n;
  for (int number = 1; trajectory.size() < stamps.size() && std::getline(file, line); ++number) {
    if (line.empty() || line == "\r") continue;
    const std::string where = at(path, number);
    if (!parse_numbers(line, n) || n.size() != 12) {
      throw InputError(where + ": not a pose; expected twelve numbers");
    }
    TimedPose pose{stamps[trajectory.size()], Eigen::Isometry3d::Identity()};
    Eigen::Matrix3d R;
    R << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0) {
      throw InputError(where + ": the matrix is not a rotation; expected one");
    }
    check_order(trajectory, pose.stamp, where);
    pose.T.linear() = nearest_rotation(R).toRotationMatrix();
    pose.T.translation() << n[3], n[7], n[11];
    trajectory.push_back(pose);
  }
  if (trajectory.size() < stamps.size()) {
    throw InputError(path + ": holds " + std::to_string(trajectory.size()) +
                     " poses; expected one for each of " + std::to_string(stamps.size()) +
                     " frames");
  }
  return trajectory;
}

std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, double stamp,
                                         double max_gap) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                       [](const TimedPose& pose, double time) { return pose.stamp < time; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T;
  if (after == trajectory.begin()) return std::nullopt;
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

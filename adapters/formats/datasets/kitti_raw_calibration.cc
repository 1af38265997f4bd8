// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/kitti_raw_calibration.h"

#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

using RawCalibration = std::map<std::string, std::vector<double>>;

RawCalibration read_raw_calibration(const std::string& path) {
  RawCalibration entries;
  std::istringstream lines(read_whole_file(path));
  std::string line;
  while (std::getline(lines, line)) {
    const auto colon = line.find(':');
    std::vector<double> numbers;
    if (colon != std::string::npos && parse_numbers(line.substr(colon + 1), numbers)) {
      entries[line.substr(0, colon)] = numbers;
    }
  }
  return entries;
}

const std::vector<double>& entry(const RawCalibration& entries, const std::string& path,
                                 const std::string& key, std::size_t size) {
  const auto found = entries.find(key);
  if (found == entries.end() || found->second.size() != size) {
    throw InputError(path + ": " + key + " is missing or has not " + std::to_string(size) +
                     " numbers; expected KITTI's calibration of the cameras");
  }
  return found->second;
}

StereoCalibration rectified_pair(const RawCalibration& entries, const std::string& path,
                                 const std::string names[2]) {
  StereoCalibration out;
  out.from = path;
  out.rectified = true;
  const auto& size = entry(entries, path, "S_rect" + names[0], 2);
  const auto& P = entry(entries, path, "P_rect" + names[0], 12);
  const auto& right = entry(entries, path, "P_rect" + names[1], 12);
  out.camera.left = {P[0], P[5], P[2], P[6], size[0], size[1]};
  out.camera.baseline = ((P[3] - P[2] * P[11]) - (right[3] - right[2] * right[11])) / P[0];
  check_baseline(path, out.camera.baseline);
  return out;
}

StereoCalibration own_pair(const RawCalibration& entries, const std::string& path,
                           const std::string names[2]) {
  StereoCalibration out;
  out.from = path;
  CalibratedCamera* const cameras[2] = {&out.left, &out.right};
  for (int i = 0; i < 2; ++i) {
    const auto& size = entry(entries, path, "S" + names[i], 2);
    const auto& K = entry(entries, path, "K" + names[i], 9);
    const auto& D = entry(entries, path, "D" + names[i], 5);
    const auto& R = entry(entries, path, "R" + names[i], 9);
    const auto& T = entry(entries, path, "T" + names[i], 3);
    cameras[i]->pinhole = {K[0], K[4], K[2], K[5], size[0], size[1]};
    set_lens(*cameras[i], "plumb_bob", D);
    Eigen::Matrix3d M;
    for (int k = 0; k < 9; ++k) M(k / 3, k % 3) = R[static_cast<std::size_t>(k)];
    // R, T: camera 0, the body, to this camera.
    cameras[i]->T_BC = checked_pose({T[0], T[1], T[2]}, M, path + ": R" + names[i]).inverse();
  }
  return out;
}

}  // namespace

bool is_kitti_raw_calibration(const std::string& path) {
  return read_raw_calibration(path).contains("P_rect_00");
}

StereoCalibration read_kitti_raw_calibration(const std::string& path, int first) {
  const RawCalibration entries = read_raw_calibration(path);
  const std::string names[2] = {"_0" + std::to_string(first), "_0" + std::to_string(first + 1)};
  StereoCalibration out = rectified_pair(entries, path, names);
  // KITTI-360's are distributed rectified; not each copy of its file has the rest.
  if (entries.contains("K" + names[0])) out.others.push_back(own_pair(entries, path, names));
  return out;
}

}  // namespace prospect

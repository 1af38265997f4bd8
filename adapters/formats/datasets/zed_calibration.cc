// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/zed_calibration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

struct ZedResolution {
  const char* name;
  double width, height;
};
constexpr ZedResolution kZedResolutions[] = {{"hd", 1280, 720},   {"2k", 2208, 1242},
                                             {"fhd", 1920, 1080}, {"vga", 672, 376},
                                             {"svga", 960, 600},  {"fhd1200", 1920, 1200}};

/// Texts by "section:key" in lower case.
using ZedEntries = std::map<std::string, std::string>;

ZedEntries read_entries(const std::string& path) {
  ZedEntries entries;
  std::istringstream lines(read_whole_file(path));
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    line = lower_case(line.substr(0, line.find_first_of(";#\r")));
    if (const auto end = line.find(']'); line.starts_with('[') && end != std::string::npos) {
      section = line.substr(1, end - 1);
      continue;
    }
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    std::string key = line.substr(0, equals);
    key.erase(key.find_last_not_of(" \t") + 1);
    key = key.substr(std::min(key.size(), key.find_first_not_of(" \t")));
    if (!entries.emplace(section + ":" + key, line.substr(equals + 1)).second) {
      throw InputError(path + ": " + key + " is stated twice in [" + section +
                       "]; expected Stereolabs' calibration of a ZED");
    }
  }
  return entries;
}

class ZedReader {
 public:
  ZedReader(const std::string& path, const ZedEntries& entries) : path_(path), entries_(entries) {}

  StereoCalibration pair(const ZedResolution& of) const {
    StereoCalibration out;
    out.from = path_;
    out.left = camera("left_cam_", of);
    out.right = camera("right_cam_", of);
    const Eigen::Vector3d turn(stereo("rx", of), stereo("cv", of), stereo("rz", of));
    const Eigen::Vector3d T(number("stereo:baseline"), stereo("ty", of), stereo("tz", of));
    Eigen::Isometry3d T_RL = Eigen::Isometry3d::Identity();
    if (turn.norm() > 0.0) {
      T_RL.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    }
    T_RL.translation() = -1e-3 * T;
    out.right.T_BC = T_RL.inverse();  // the body is the left camera
    return out;
  }

 private:
  double number(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
      throw InputError(path_ + ": " + name.substr(name.find(':') + 1) + " is missing in [" +
                       name.substr(0, name.find(':')) +
                       "]; expected Stereolabs' calibration of a ZED");
    }
    std::vector<double> numbers;
    if (!parse_numbers(found->second, numbers) || numbers.size() != 1) {
      throw InputError(path_ + ": " + name.substr(name.find(':') + 1) + " in [" +
                       name.substr(0, name.find(':')) + "] is '" + found->second +
                       "'; expected one number");
    }
    return numbers[0];
  }
  /// Of a resolution, of all, or 0.
  double stereo(const std::string& key, const ZedResolution& of) const {
    for (const std::string& name : {"stereo:" + key + "_" + of.name, "stereo:" + key}) {
      if (entries_.contains(name)) return number(name);
    }
    return 0.0;
  }
  CalibratedCamera camera(const std::string& side, const ZedResolution& of) const {
    const std::string section = side + of.name + ":";
    CalibratedCamera out;
    out.pinhole = {number(section + "fx"),
                   number(section + "fy"),
                   number(section + "cx"),
                   number(section + "cy"),
                   of.width,
                   of.height};
    if (!(out.pinhole.fx > 0.0 && out.pinhole.fy > 0.0)) {
      throw InputError(path_ + ": fx or fy in [" + side + of.name +
                       "] is not positive; expected focal lengths");
    }
    std::vector<double> k;
    for (const char* key : {"k1", "k2", "p1", "p2"}) k.push_back(number(section + key));
    k.push_back(entries_.contains(section + "k3") ? number(section + "k3") : 0.0);
    set_lens(out, "radtan", k);
    return out;
  }

  const std::string& path_;
  const ZedEntries& entries_;
};

}  // namespace

StereoCalibration read_zed_calibration(const std::string& path) {
  const ZedEntries entries = read_entries(path);
  const ZedReader reader(path, entries);
  StereoCalibration all;
  for (const ZedResolution& resolution : kZedResolutions) {
    if (!entries.contains(std::string("left_cam_") + resolution.name + ":fx")) continue;
    all.others.push_back(reader.pair(resolution));
  }
  if (all.others.empty()) reader.pair(kZedResolutions[0]);  // says what is missing
  StereoCalibration out = all.others.front();
  out.others.assign(all.others.begin() + 1, all.others.end());
  return out;
}

}  // namespace prospect

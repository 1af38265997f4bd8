// SPDX-License-Identifier: Apache-2.0
// Logs of CARMEN, in which most public 2-D data sets are kept: a message a line.
//   FLASER n r_1 ... r_n x y theta odom_x odom_y odom_theta time host logger_time
//   ROBOTLASER1 type start_angle field_of_view angular_resolution max_range accuracy remission_mode
//     n r_1 ... r_n m remission_1 ... remission_m x y theta robot_x robot_y robot_theta tv rv
//     forward side turn_axis time host logger_time
// x y theta is the pose of the lidar, which logs of a SLAM program have corrected. FLASER states no
// angles: half a turn, as CARMEN reads it. The rear lidar (RLASER, ROBOTLASER2) has the name of its
// line; it is passed over, as are lines of other kinds, and both are counted.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/datasets/scan_source.h"
#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {
namespace {

constexpr double kMaxRange = 81.0;  // of FLASER: a SICK LMS says 81.83 or 81.91 for nothing [m]
constexpr int kMostLinesLookedAt = 500;

struct CarmenScan {
  double stamp = 0.0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  RosLaserScan scan;
};

/// The words of a line, by turns.
class Words {
 public:
  Words(const std::string& line, std::string where) : stream_(line), where_(std::move(where)) {}
  std::string word(const char* what) {
    std::string word;
    if (!(stream_ >> word)) fail(where_, "ends before " + std::string(what) + "; expected it");
    return word;
  }
  double number(const char* what) {
    const std::string text = word(what);
    double value = 0.0;
    if (!parse_number(text, value) || !std::isfinite(value)) {
      fail(where_, "'" + text + "' for " + what + "; expected a number");
    }
    return value;
  }
  std::size_t count(const char* what) {
    const double value = number(what);
    if (!(value >= 0.0 && value <= 100000.0) || value != std::floor(value)) {
      fail(where_, std::string(what) + " is not a number of readings; expected 0 to 100000");
    }
    return static_cast<std::size_t>(value);
  }
  std::vector<float> ranges(std::size_t n) {
    std::vector<float> out(n);
    for (float& r : out) {
      // Some logs write inf or nan, which are no numbers to others.
      const std::string text = word("a range");
      double value = 0.0;
      if (!parse_number(text, value)) fail(where_, "'" + text + "' for a range; expected a number");
      r = static_cast<float>(value);
    }
    return out;
  }

 private:
  std::istringstream stream_;
  std::string where_;
};

CarmenScan parse_scan(const std::string& line, const std::string& where) {
  Words words(line, where);
  CarmenScan out;
  RosLaserScan& scan = out.scan;
  std::size_t after_pose = 3;
  if (words.word("its name") == "FLASER") {
    const std::size_t n = words.count("the number of readings");
    scan.ranges = words.ranges(n);
    scan.angle_min = -0.5 * M_PI;
    scan.angle_increment =
        M_PI / static_cast<double>(std::max<std::size_t>(1, n % 2 == 0 ? n : n - 1));
    scan.range_max = kMaxRange;
  } else {
    words.number("the type");
    scan.angle_min = words.number("the start angle");
    words.number("the field of view");
    scan.angle_increment = words.number("the angular resolution");
    scan.range_max = words.number("the maximum range");
    words.number("the accuracy");
    words.number("the remission mode");
    scan.ranges = words.ranges(words.count("the number of readings"));
    words.ranges(words.count("the number of remissions"));
    after_pose = 8;
    if (!(scan.range_max > 0.0)) fail(where, "a maximum range that is not positive; expected one");
  }
  // What is at the end of the range or beyond is nothing seen.
  for (float& r : scan.ranges) r = std::min(r, static_cast<float>(scan.range_max));
  const double x = words.number("x"), y = words.number("y"), theta = words.number("theta");
  out.T.translation() << x, y, 0.0;
  out.T.linear() = Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t i = 0; i < after_pose; ++i) words.number("the robot's pose");
  out.stamp = words.number("the time");
  return out;
}

bool is_front_scan(const std::string& line) {
  return line.starts_with("FLASER ") || line.starts_with("ROBOTLASER1 ");
}

}  // namespace

bool is_carmen_log(const std::string& path) {
  std::error_code error;
  const std::string ending = lower_case_extension(path);
  if (ending == ".clf" || ending == ".carmen") {
    return std::filesystem::is_regular_file(path, error);
  }
  if (ending != ".log" || !std::filesystem::is_regular_file(path, error)) return false;
  // Many programs write a .log: this one names its messages.
  std::ifstream file(path);
  std::string line;
  for (int i = 0; i < kMostLinesLookedAt && std::getline(file, line); ++i) {
    if (is_front_scan(line) || line.starts_with("# CARMEN")) return true;
  }
  return false;
}

ScanSource open_carmen_log(const std::string& path, const ScanOptions& options) {
  ScanSource source;
  source.layout = "CARMEN log";
  source.from = path;
  source.fixed = "the log's laser poses";
  source.attempt([&] {
    if (!options.topics.empty() || !options.fixed_frame.empty()) {
      throw InputError(path +
                       ": a log has neither topics nor frames; expected --topics and "
                       "--fixed-frame with a bag only");
    }
    std::ifstream file(path);
    if (!file) throw InputError(path + ": cannot be read; expected a log of CARMEN");
    auto scans = std::make_shared<std::vector<RosLaserScan>>();
    std::map<std::string, std::size_t> passed_over;
    Elements elements("scans");
    std::size_t number = 0, out_of_order = 0;
    for (std::string line; std::getline(file, line);) {
      ++number;
      if (line.ends_with('\r')) line.pop_back();
      if (!is_front_scan(line)) {
        const std::string kind = line.substr(0, line.find_first_of(" \t"));
        if (!kind.empty() && kind[0] != '#') ++passed_over[kind];
        continue;
      }
      CarmenScan read;
      if (!elements.read([&] { read = parse_scan(line, path + ":" + std::to_string(number)); })) {
        continue;
      }
      if (!source.stamps.empty() && !(read.stamp > source.stamps.back())) {
        ++out_of_order;
        continue;
      }
      source.stamps.push_back(read.stamp);
      source.poses.push_back(read.T);
      scans->push_back(std::move(read.scan));
    }
    elements.finish(source.notes);
    source.scans = scans->size() + out_of_order;
    if (scans->empty()) {
      throw InputError(path + ": holds no FLASER or ROBOTLASER1 line; expected scans of a lidar");
    }
    source.max_range = (*scans)[0].range_max;
    source.points = (*scans)[0].ranges.size();
    if (out_of_order > 0) {
      source.notes.push_back(std::to_string(out_of_order) +
                             " scans whose time does not increase left out");
    }
    std::string list;
    for (const auto& [kind, count] : passed_over) {
      list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
    }
    if (!list.empty()) source.notes.push_back("read without lines of other kinds: " + list);
    source.read = [scans](std::size_t i) { return rays_of(scans->at(i)); };
  });
  return source;
}

}  // namespace prospect

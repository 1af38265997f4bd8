// SPDX-License-Identifier: Apache-2.0
// mav0/cam0 and mav0/cam1, or cam0 and cam1, each with sensor.yaml and data/STAMP.png.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/files/strict_yaml.h"

namespace prospect {
namespace {

struct EurocSensor {
  CalibratedCamera camera;
  double rate = 0.0;  ///< [Hz]; 0: not stated
};

std::string euroc_root(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  return fs::is_directory(path + "/mav0", error) ? path + "/mav0" : path;
}

EurocSensor read_sensor(const std::string& path, std::vector<std::string>& notes) {
  std::string text = read_whole_file(path);
  // OpenCV's directive is not YAML's; the lines keep their numbers.
  if (!text.empty() && text[0] == '%') text.insert(0, "#");
  StrictYaml yaml = StrictYaml::from_text(text, path);
  YamlMap root = yaml.root();
  root.choice("sensor_type", "camera", {"camera"}, "kind of sensor");
  root.text("comment", "none", "free text");
  root.text("camera_id", "none", "free text");  // Kimera's
  EurocSensor sensor;
  sensor.rate = root.number("rate_hz", 0.0, 0.01, 10000.0, "Hz", "frame rate");
  root.required_choice("camera_model", {"pinhole"}, "projection");
  const std::string model = root.required_text("distortion_model", "distortion");
  const auto resolution = root.required_numbers("resolution", 2, 16, 16384, "px", "width, height");
  const auto intrinsics = root.required_numbers("intrinsics", 4, 1, 100000, "px", "fu, fv, cu, cv");
  const auto distortion = root.required_numbers("distortion_coefficients", -1, -100, 100, "1",
                                                "k1, k2, p1, p2, k3 or k1 to k4");
  YamlMap T = root.map("T_BS");
  T.integer("cols", 4, 4, 4, "1", "columns");
  T.integer("rows", 4, 4, 4, "1", "rows");
  const auto data = T.required_numbers("data", 16, -1000, 1000, "1", "camera to body, by rows");
  if (root.problem_count() == 0) {
    const std::string problem = set_lens(sensor.camera, model, distortion);
    if (!problem.empty()) {
      root.problem(problem.starts_with("has") ? "distortion_coefficients" : "distortion_model",
                   problem);
    }
  }
  std::string rest;
  for (const std::string& key : root.leave_rest()) rest += (rest.empty() ? "" : ", ") + key;
  for (const std::string& key : T.leave_rest())
    rest += (rest.empty() ? "" : ", ") + ("T_BS." + key);
  if (!rest.empty()) notes.push_back(path + ": passed over: " + rest);
  yaml.finish();
  sensor.camera.pinhole = {intrinsics[0], intrinsics[1], intrinsics[2],
                           intrinsics[3], resolution[0], resolution[1]};
  Eigen::Matrix4d M;
  for (int i = 0; i < 16; ++i) M(i / 4, i % 4) = data[i];
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0 ||
      M.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw InputError(path + ": T_BS is not a rotation and translation; expected one");
  }
  sensor.camera.T_BC.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  sensor.camera.T_BC.translation() = M.topRightCorner<3, 1>();
  return sensor;
}

/// Time [any unit], position, quaternion (w first, unless the columns' names say otherwise) and
/// more a line: times in `unit`.
Trajectory read_euroc_truth(const std::string& csv, double unit, std::vector<std::string>& notes) {
  Trajectory body;
  Elements poses("poses of " + csv);
  std::istringstream lines(read_whole_file(csv));
  std::string line;
  std::vector<double> n;
  bool w_first = true;
  for (int k = 1; std::getline(lines, line); ++k) {
    // Not all tools mark the line of names by #.
    const std::optional<bool> named = names_w_first(line);
    if (named) w_first = *named;
    if (named || line.empty() || line[0] == '#' || line == "\r") continue;
    const std::string where = csv + ":" + std::to_string(k);
    if (!parse_any_numbers(line, n) || n.size() < 8 || !std::isfinite(n[0]) ||
        (!body.empty() && !(n[0] * unit > body.back().stamp))) {
      throw InputError(where +
                       ": not a pose; expected time [ns], position, quaternion (w first), times "
                       "that increase");
    }
    poses.read([&] {
      const Eigen::Quaterniond q = w_first ? Eigen::Quaterniond(n[4], n[5], n[6], n[7])
                                           : Eigen::Quaterniond(n[7], n[4], n[5], n[6]);
      body.push_back({n[0] * unit, checked_pose({n[1], n[2], n[3]}, q, where)});
    });
  }
  poses.finish(notes);
  if (!w_first) notes.push_back(csv + ": its quaternions have w last, as its header says");
  return body;
}

}  // namespace

bool is_euroc(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::string root = euroc_root(path);
  return root != path || fs::exists(root + "/cam0/sensor.yaml", error) ||
         (fs::is_directory(root + "/cam0/data", error) &&
          fs::is_directory(root + "/cam1/data", error));
}

StereoSource open_euroc(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  StereoSource source;
  source.layout = "EuRoC";
  const std::string root = euroc_root(path);
  const std::string cameras[2] = {root + "/cam0", root + "/cam1"};
  double rate = options.rate.value_or(0.0);
  if (!options.calibration.empty()) {
    source.attempt([&] {
      source.calibration = read_stereo_calibration(options.calibration, options.rectified);
    });
  } else {
    source.attempt([&] {
      const EurocSensor left = read_sensor(cameras[0] + "/sensor.yaml", source.notes);
      const EurocSensor right = read_sensor(cameras[1] + "/sensor.yaml", source.notes);
      StereoCalibration calibration;
      calibration.left = left.camera;
      calibration.right = right.camera;
      calibration.from = cameras[1] + "/sensor.yaml";
      check_principal_point(cameras[0] + "/sensor.yaml", left.camera.pinhole);
      check_principal_point(cameras[1] + "/sensor.yaml", right.camera.pinhole);
      source.calibration = calibration;
      if (!options.rate) rate = left.rate;
    });
  }
  double unit = 1e-9;
  ImageStream* const streams[2] = {&source.left, &source.right};
  bool counted = false;
  for (int i = 0; i < 2; ++i) {
    source.attempt([&] {
      const std::string folder = cameras[i] + "/data";
      const NumberedImages images = numbered_images(folder);
      std::vector<std::int64_t> numbers;
      std::vector<std::string> paths;
      for (const NumberedImage& image : images.images) {
        numbers.push_back(image.number);
        paths.push_back(image.path);
      }
      if (i == 0) {
        // Small numbers are stamps from 0 on, if they fit the rate; else they count frames.
        counted = !images.decimal && counts_frames(numbers);
        if (counted) {
          unit = 1.0 / (rate > 0.0 ? rate : 10.0);
          source.times_assumed = true;
          source.notes.push_back("images are numbered, not stamped: " + number_text(1.0 / unit) +
                                 " Hz assumed; --rate HZ states another");
        } else if (!images.decimal) {
          const auto found = stamp_unit(numbers);
          if (!found) {
            throw InputError(folder +
                             ": stamps whose unit cannot be told, as in no unit they come 0.2 to "
                             "200 times a second; expected ns");
          }
          unit = found->seconds;
          if (unit != 1e-9) {
            source.notes.push_back("stamps in " + std::string(found->name) +
                                   ", by their rate; EuRoC's are in ns");
          }
        } else {
          source.notes.push_back("stamps in s, with a decimal point; EuRoC's are in ns");
        }
      }
      std::vector<double> stamps;
      for (const std::int64_t number : numbers) {
        stamps.push_back(static_cast<double>(number) * unit);
      }
      *streams[i] = image_files(folder, std::move(stamps), std::move(paths));
    });
  }
  source.truth_of_body = options.calibration.empty();
  source.attempt([&] {
    const std::string csv = root + "/state_groundtruth_estimate0/data.csv";
    const std::string tum = path + "/groundtruth_tum.txt";
    if (fs::exists(tum)) {
      source.truth = read_tum_trajectory(tum, source.notes);
      source.truth_of_quaternions = true;
    } else if (fs::exists(csv)) {
      const double taken = counted ? 1e-9 : unit;
      source.truth = read_euroc_truth(csv, taken, source.notes);
      const auto apart = [&] {
        return source.left.size() > 0 &&
               (source.truth.empty() || source.truth.back().stamp < source.left.stamps.front() ||
                source.truth.front().stamp > source.left.stamps.back());
      };
      if (taken != 1e-9 && apart()) {  // in ns though the images' names are not
        for (TimedPose& pose : source.truth) pose.stamp *= 1e-9 / taken;
      }
    }
  });
  if (options.calibration.empty() && !counted) {
    source.imu = read_euroc_imu(root, 1e-9, source.notes);
    source.imu_in_body = true;
  }
  return source;
}

}  // namespace prospect

// A drive of the KITTI raw data: image_00 to image_03 with data and timestamps.txt,
// calib_cam_to_cam.txt beside it or in the folder of the day, above.

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/stereo_source.h"

namespace prospect {
namespace {

std::string raw_calibration(const std::string& path) {
  namespace fs = std::filesystem;
  const std::string beside = path + "/calib_cam_to_cam.txt";
  if (fs::exists(beside)) return beside;
  const fs::path folder = fs::absolute(path + "/x").lexically_normal().parent_path();
  return (folder.parent_path() / "calib_cam_to_cam.txt").string();
}

/// "2011-09-26 13:02:25.964389445" a line, as seconds since 1970; 0 where a camera has no stamp.
std::vector<double> read_raw_times(const std::string& path) {
  std::vector<double> times;
  std::istringstream lines(read_whole_file(path));
  std::string line;
  for (int n = 1; std::getline(lines, line); ++n) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
    std::vector<double> second;
    if (std::sscanf(line.c_str(), "%d-%d-%d %d:%d:%n", &year, &month, &day, &hour, &minute,
                    &used) != 5 ||
        used == 0 || month < 1 || month > 12 || !parse_numbers(line.substr(used), second) ||
        second.size() != 1) {
      throw InputError(path + ":" + std::to_string(n) +
                       ": not a time; expected 2011-09-26 13:02:25.964389445");
    }
    // Days since 1970 of the Gregorian calendar, years that begin in March.
    const int y = month > 2 ? year : year - 1, m = month > 2 ? month - 3 : month + 9;
    const int days = 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
    times.push_back(86400.0 * days + 3600.0 * hour + 60.0 * minute + second[0]);
  }
  return times;
}

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

/// Of rectified images, by P_rect; of the cameras' own, by K, D, R and T, if that is their size.
StereoCalibration raw_stereo_calibration(const std::string& path, int first, int width,
                                         int height) {
  const RawCalibration entries = read_raw_calibration(path);
  const std::string names[2] = {"_0" + std::to_string(first), "_0" + std::to_string(first + 1)};
  StereoCalibration out;
  out.from = path;
  const auto& rectified_size = entry(entries, path, "S_rect" + names[0], 2);
  if (rectified_size[0] == width && rectified_size[1] == height) {
    const auto& P = entry(entries, path, "P_rect" + names[0], 12);
    const auto& right = entry(entries, path, "P_rect" + names[1], 12);
    out.rectified = true;
    out.camera.left = {P[0], P[5], P[2], P[6], rectified_size[0], rectified_size[1]};
    out.camera.baseline = ((P[3] - P[2] * P[11]) - (right[3] - right[2] * right[11])) / P[0];
    check_baseline(path, out.camera.baseline);
    return out;
  }
  const auto& size = entry(entries, path, "S" + names[0], 2);
  if (size[0] != width || size[1] != height) {
    throw InputError(path + ": is for images of " + number_text(size[0]) + " x " +
                     number_text(size[1]) + " px, or " + number_text(rectified_size[0]) + " x " +
                     number_text(rectified_size[1]) + " px rectified, but these have " +
                     std::to_string(width) + " x " + std::to_string(height) +
                     "; expected the calibration of the same day");
  }
  CalibratedCamera* const cameras[2] = {&out.left, &out.right};
  for (int i = 0; i < 2; ++i) {
    const auto& K = entry(entries, path, "K" + names[i], 9);
    const auto& D = entry(entries, path, "D" + names[i], 5);
    const auto& R = entry(entries, path, "R" + names[i], 9);
    const auto& T = entry(entries, path, "T" + names[i], 3);
    cameras[i]->pinhole = {K[0], K[4], K[2], K[5], size[0], size[1]};
    set_lens(*cameras[i], "plumb_bob", D);
    // Camera 0, the body, to this camera.
    Eigen::Isometry3d T_CB = Eigen::Isometry3d::Identity();
    Eigen::Matrix3d M;
    for (int k = 0; k < 9; ++k) M(k / 3, k % 3) = R[static_cast<std::size_t>(k)];
    T_CB.linear() = Eigen::Quaterniond(M).normalized().toRotationMatrix();
    T_CB.translation() << T[0], T[1], T[2];
    cameras[i]->T_BC = T_CB.inverse();
  }
  return out;
}

}  // namespace

bool is_kitti_raw(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_directory(path + "/image_00/data", error) ||
         std::filesystem::is_directory(path + "/image_02/data", error);
}

StereoSource open_kitti_raw(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  StereoSource source;
  source.layout = "KITTI raw";
  std::error_code error;
  int first = 0;
  if (!fs::is_directory(path + "/image_00/data", error) ||
      !fs::is_directory(path + "/image_01/data", error)) {
    first = 2;
    source.notes.push_back("the colour pair, image_02 and image_03, as grey");
  }
  for (int i = 0; i < 2; ++i) {
    source.attempt([&] {
      const std::string camera = path + "/image_0" + std::to_string(first + i);
      const NumberedImages images = numbered_images(camera + "/data");
      const std::string stamps_path = camera + "/timestamps.txt";
      const bool timed = fs::exists(stamps_path);
      std::vector<double> times;
      if (timed) times = read_raw_times(stamps_path);
      if (!timed && i == 0) {
        source.times_assumed = !options.rate;
        source.notes.push_back("no timestamps.txt: " + number_text(options.rate.value_or(10.0)) +
                               " Hz assumed");
      }
      std::vector<double> stamps;
      std::vector<std::string> paths;
      for (const NumberedImage& image : images.images) {
        if (timed && image.number >= static_cast<std::int64_t>(times.size())) {
          throw InputError(stamps_path + ": holds " + std::to_string(times.size()) +
                           " times; expected one for image " + std::to_string(image.number));
        }
        const double stamp = timed
                                 ? times[static_cast<std::size_t>(image.number)]
                                 : static_cast<double>(image.number) / options.rate.value_or(10.0);
        if (!stamps.empty() && !(stamp > stamps.back())) {
          throw InputError(stamps_path + ":" + std::to_string(image.number + 1) +
                           ": the time does not increase; expected increasing times");
        }
        stamps.push_back(stamp);
        paths.push_back(image.path);
      }
      (i == 0 ? source.left : source.right) =
          image_files(camera + "/data", std::move(stamps), std::move(paths));
    });
  }
  source.attempt([&] {
    if (!options.calibration.empty()) {
      source.calibration = read_stereo_calibration(options.calibration, options.rectified);
      return;
    }
    const std::string file = raw_calibration(path);
    if (!fs::exists(file)) {
      throw InputError(path +
                       ": calib_cam_to_cam.txt is neither there nor in the folder above; expected "
                       "it, or --calibration FILE");
    }
    if (source.left.size() == 0) return;  // said already
    const RawImage image = source.left.read(0);
    source.calibration = raw_stereo_calibration(file, first, image.width, image.height);
  });
  if (fs::is_directory(path + "/oxts", error)) {
    source.notes.push_back("oxts (satellite navigation) is not read: no ground truth");
  }
  return source;
}

}  // namespace prospect

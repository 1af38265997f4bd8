// SPDX-License-Identifier: Apache-2.0
// A drive of the KITTI raw data: image_00 to image_03 with data and timestamps.txt,
// calib_cam_to_cam.txt beside it or in the folder of the day, above. Or of KITTI-360: data_rect for
// data, and calibration/perspective.txt beside the folder of the drives.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/kitti_raw_calibration.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {
namespace {

/// "" if there is none.
std::string raw_calibration(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(path + "/x").lexically_normal().parent_path();
  for (const fs::path& above : {folder, folder.parent_path()}) {
    for (const char* name : {"calib_cam_to_cam.txt", "perspective.txt"}) {
      if (fs::exists(above / name, error)) return (above / name).string();
    }
  }
  const fs::path file = folder.parent_path().parent_path() / "calibration" / "perspective.txt";
  return fs::exists(file, error) ? file.string() : "";
}

/// The folder of a camera's images that a drive has, "" if it has none: of KITTI, of KITTI-360.
std::string raw_images(const std::string& camera) {
  std::error_code error;
  for (const char* name : {"/data", "/data_rect"}) {
    if (std::filesystem::is_directory(camera + name, error)) return camera + name;
  }
  return {};
}

/// Of KITTI-360: images of a fisheye, of which there is no pair.
bool is_fisheye(const std::string& camera) {
  std::error_code error;
  return std::filesystem::is_directory(camera + "/data_rgb", error);
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

/// Of KITTI-360, data_poses/DRIVE/cam0_to_world.txt beside the folder of the drives, or in the
/// drive; "" if there is none.
std::string poses_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(path + "/x").lexically_normal().parent_path();
  const fs::path above = folder.parent_path().parent_path() / "data_poses" / folder.filename();
  for (const fs::path& place : {folder, above}) {
    if (fs::exists(place / "cam0_to_world.txt", error)) {
      return (place / "cam0_to_world.txt").string();
    }
  }
  return "";
}

/// The number of an image and the 4 x 4 matrix of the rectified camera 0 to the world a line; not
/// each image has one. Times are those of the images.
Trajectory read_cam0_to_world(const std::string& path, const std::vector<std::int64_t>& numbers,
                              const std::vector<double>& stamps, std::vector<std::string>& notes) {
  Trajectory truth;
  Elements poses("poses of " + path);
  std::istringstream lines(read_whole_file(path));
  std::string line;
  std::vector<double> n;
  for (int k = 1; std::getline(lines, line); ++k) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = path + ":" + std::to_string(k);
    if (!parse_any_numbers(line, n) || n.size() != 17 || !(std::abs(n[0]) < 1e15) ||
        n[0] != std::floor(n[0])) {
      throw InputError(where +
                       ": not a pose; expected the number of an image and a 4 x 4 matrix by rows");
    }
    const auto image =
        std::lower_bound(numbers.begin(), numbers.end(), static_cast<std::int64_t>(n[0]));
    if (image == numbers.end() || *image != static_cast<std::int64_t>(n[0])) continue;
    const double stamp = stamps[static_cast<std::size_t>(image - numbers.begin())];
    if (!truth.empty() && !(stamp > truth.back().stamp)) {
      throw InputError(where + ": the number does not increase; expected increasing ones");
    }
    poses.read([&] {
      const Eigen::Matrix3d R{{n[1], n[2], n[3]}, {n[5], n[6], n[7]}, {n[9], n[10], n[11]}};
      truth.push_back({stamp, checked_pose({n[4], n[8], n[12]}, R, where)});
    });
  }
  poses.finish(notes);
  return truth;
}

}  // namespace

bool is_kitti_raw(const std::string& path) {
  return !raw_images(path + "/image_00").empty() || !raw_images(path + "/image_02").empty() ||
         is_fisheye(path + "/image_02");
}

StereoSource open_kitti_raw(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  StereoSource source;
  std::error_code error;
  int first = 0;
  std::string folders[2];
  const auto find_pair = [&](int number) {
    for (int i = 0; i < 2; ++i) {
      folders[i] = raw_images(path + "/image_0" + std::to_string(number + i));
    }
    return !folders[0].empty() && !folders[1].empty();
  };
  if (!find_pair(0) && find_pair(2)) {
    first = 2;
    source.notes.emplace_back("the colour pair, image_02 and image_03, as grey");
  }
  source.layout = folders[0].ends_with("/data_rect") ? "KITTI-360" : "KITTI raw";
  std::vector<std::int64_t> left_numbers;
  for (int i = 0; i < 2; ++i) {
    source.attempt([&] {
      const std::string camera = path + "/image_0" + std::to_string(first + i);
      if (folders[i].empty()) {
        throw InputError(camera + ": holds neither data nor data_rect; expected the images of " +
                         (is_fisheye(path + "/image_02")
                              ? "image_00 and image_01: the fisheye cameras of KITTI-360, image_02 "
                                "and image_03 with data_rgb, look to the sides and are no pair"
                              : "a pair"));
      }
      const NumberedImages images = numbered_images(folders[i]);
      std::vector<std::int64_t> numbers;
      std::vector<std::string> paths;
      for (const NumberedImage& image : images.images) {
        numbers.push_back(image.number);
        paths.push_back(image.path);
      }
      if (i == 0) left_numbers = numbers;
      const std::string stamps_path = camera + "/timestamps.txt";
      std::vector<double> stamps;
      if (fs::exists(stamps_path, error)) {
        const std::vector<double> times = read_raw_times(stamps_path);
        for (const std::size_t line :
             lines_of_images(numbers, times.size(), stamps_path, source.notes)) {
          if (!stamps.empty() && !(times[line] > stamps.back())) {
            throw InputError(stamps_path + ":" + std::to_string(line + 1) +
                             ": the time does not increase; expected increasing times");
          }
          stamps.push_back(times[line]);
        }
      } else {
        if (i == 0) {
          source.times_assumed = !options.rate;
          source.notes.push_back("no timestamps.txt: " + number_text(options.rate.value_or(10.0)) +
                                 " Hz assumed");
        }
        for (const std::int64_t k : numbers) {
          stamps.push_back(static_cast<double>(k) / options.rate.value_or(10.0));
        }
      }
      (i == 0 ? source.left : source.right) =
          image_files(folders[i], std::move(stamps), std::move(paths));
    });
  }
  source.attempt([&] {
    const std::string file =
        options.calibration.empty() ? raw_calibration(path) : options.calibration;
    if (file.empty()) {
      throw InputError(path +
                       ": calib_cam_to_cam.txt is neither there nor in the folder above, nor is "
                       "../../calibration/perspective.txt; expected one, or --calibration FILE");
    }
    source.calibration = options.calibration.empty() || is_kitti_raw_calibration(file)
                             ? read_kitti_raw_calibration(file, first)
                             : read_stereo_calibration(file, options.rectified);
  });
  if (const std::string poses = poses_file(path); !poses.empty() && first == 0) {
    source.attempt([&] {
      if (left_numbers.size() != source.left.size()) return;  // its images are missing
      source.truth = read_cam0_to_world(poses, left_numbers, source.left.stamps, source.notes);
      source.notes.push_back("ground truth from " + poses);
    });
  } else if (fs::is_directory(path + "/oxts", error)) {
    source.notes.emplace_back("oxts (satellite navigation) is not read: no ground truth");
  }
  return source;
}

}  // namespace prospect

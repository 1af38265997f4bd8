// SPDX-License-Identifier: Apache-2.0
// Two folders of images beside each other, or two videos, or one with both images side by side.
// With calib.txt: KITTI odometry. Else with a calibration file beside them, or the one that is
// given.

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <tuple>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/datasets/video_file.h"

namespace prospect {
namespace {

/// Names of the two folders, or of the two videos without their endings; the first pair that is
/// there counts. `first` is the number of the left camera in KITTI's calib.txt.
struct FolderNames {
  const char* left;
  const char* right;
  int first;
};
constexpr FolderNames kFolderNames[] = {{"image_l", "image_r", 0},
                                        {"image_0", "image_1", 0},
                                        {"image_2", "image_3", 2},
                                        {"left", "right", 0},
                                        {"Left", "Right", 0},
                                        {"image_left", "image_right", 0},
                                        {"left_images", "right_images", 0},
                                        {"images_left", "images_right", 0},
                                        {"images/left", "images/right", 0},
                                        {"cam0", "cam1", 0},
                                        {"infra1", "infra2", 0}};

std::string image_folder(const std::string& folder) {
  std::error_code error;
  return std::filesystem::is_directory(folder + "/data", error) ? folder + "/data" : folder;
}

const FolderNames* find_folders(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const FolderNames& names : kFolderNames) {
    if (fs::is_directory(path + "/" + names.left, error) &&
        fs::is_directory(path + "/" + names.right, error)) {
      return &names;
    }
  }
  return nullptr;
}

/// The first names of which both videos are there, in `videos`.
const FolderNames* find_videos(const std::string& path, std::string videos[2]) {
  for (const FolderNames& names : kFolderNames) {
    videos[0] = find_video(path + "/" + names.left);
    if (videos[0].empty()) continue;
    videos[1] = find_video(path + "/" + names.right);
    if (!videos[1].empty()) return &names;
  }
  return nullptr;
}

/// A calibration that lies beside the images under a usual name, "" if none does.
std::string calibration_beside(const std::string& path, const FolderNames& names) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const char* name : {"camchain.yaml", "calibration.yaml", "calib.yaml", "stereo.yaml",
                           "calibration.yml", "calib.yml", "stereo.yml"}) {
    const std::string file = path + "/" + name;
    if (fs::is_regular_file(file, error)) return file;
  }
  const auto pair = [&](const std::string& left, const std::string& right) -> std::string {
    return fs::is_regular_file(left, error) && fs::is_regular_file(right, error)
               ? left + "," + right
               : "";
  };
  const std::string left = path + "/" + names.left, right = path + "/" + names.right;
  for (const std::string& found : {pair(path + "/intrinsics.yml", path + "/extrinsics.yml"),
                                   pair(left + ".yaml", right + ".yaml"),
                                   pair(left + "/camera_info.yaml", right + "/camera_info.yaml"),
                                   pair(path + "/left.yaml", path + "/right.yaml")}) {
    if (!found.empty()) return found;
  }
  return {};
}

std::vector<double> read_kitti_times(const std::string& path) {
  std::vector<double> times, numbers;
  std::istringstream lines(read_whole_file(path));
  std::string line;
  for (int n = 1; std::getline(lines, line); ++n) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (!parse_numbers(line, numbers) || numbers.size() != 1 ||
        (!times.empty() && !(numbers[0] > times.back()))) {
      throw InputError(path + ":" + std::to_string(n) +
                       ": not an increasing time; expected one a line [s]");
    }
    times.push_back(numbers[0]);
  }
  return times;
}

/// poses.txt, or ../../poses/NAME.txt; "" if neither is there.
std::string kitti_poses(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string beside = folder + "/poses.txt";
  if (fs::exists(beside)) return beside;
  const fs::path path = fs::absolute(folder + "/calib.txt").lexically_normal().parent_path();
  const std::string above =
      (path.parent_path().parent_path() / "poses" / (path.filename().string() + ".txt")).string();
  return fs::exists(above) ? above : "";
}

/// `left_position`: as for read_kitti_calibration().
void find_calibration(const std::string& path, const FolderNames& names,
                      const StereoDatasetOptions& options, StereoSource& source,
                      Eigen::Vector3d* left_position = nullptr) {
  const std::string beside = calibration_beside(path, names);
  source.attempt([&] {
    if (!options.calibration.empty()) {
      source.calibration = read_stereo_calibration(options.calibration, options.rectified);
    } else if (std::filesystem::is_regular_file(path + "/calib.txt")) {
      source.calibration = read_kitti_calibration(path + "/calib.txt", names.first, left_position);
    } else if (!beside.empty()) {
      source.calibration = read_stereo_calibration(beside, options.rectified);
      source.notes.push_back("calibration from " + beside);
    } else {
      throw InputError(path +
                       ": no file states the calibration; expected calib.txt of a rectified pair "
                       "(P0: f 0 cx 0 0 f cy 0 0 0 1 0, and P1 likewise with -f * baseline in "
                       "fourth place), or --calibration FILE (ROS camera_info, OpenCV stereo or "
                       "Kalibr's camchain)");
    }
  });
}

}  // namespace

bool is_folder_pair(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path + "/calib.txt", error) ||
         find_folders(path) != nullptr;
}

StereoSource open_folder_pair(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  StereoSource source;
  const FolderNames* found = find_folders(path);
  const FolderNames names = found != nullptr ? *found : kFolderNames[1];
  const bool kitti = fs::is_regular_file(path + "/calib.txt");
  source.layout = kitti ? "KITTI" : "folders";
  if (names.first == 2) source.notes.push_back("the colour pair, image_2 and image_3, as grey");
  Eigen::Vector3d left_position = Eigen::Vector3d::Zero();
  find_calibration(path, names, options, source, &left_position);

  NumberedImages images[2];
  const std::string folders[2] = {image_folder(path + "/" + names.left),
                                  image_folder(path + "/" + names.right)};
  for (int i = 0; i < 2; ++i) {
    if (!source.attempt([&] { images[i] = numbered_images(folders[i]); })) return source;
  }
  std::vector<std::int64_t> numbers[2];
  std::vector<std::string> paths[2];
  for (int i = 0; i < 2; ++i) {
    for (const NumberedImage& image : images[i].images) {
      numbers[i].push_back(image.number);
      paths[i].push_back(image.path);
    }
  }
  const std::string times_path = path + "/times.txt";
  std::vector<double> stamps[2];
  const bool counted = !images[0].decimal && counts_frames(numbers[0]);
  const bool timed = fs::exists(times_path);
  std::vector<double> times;
  if (timed) {
    const bool read = source.attempt([&] {
      times = read_kitti_times(times_path);
      for (int i = 0; i < 2; ++i) {
        for (const std::size_t line :
             lines_of_images(numbers[i], times.size(), times_path, source.notes)) {
          stamps[i].push_back(times[line]);
        }
      }
    });
    if (!read) return source;
    if (const auto unit = unit_instead_of_seconds(times)) {
      source.notes.push_back("times.txt in " + std::string(unit->name) +
                             ", by their rate; KITTI's are in s");
      for (std::vector<double>& camera : stamps) {
        for (double& stamp : camera) stamp *= unit->seconds;
      }
    }
    const std::int64_t last = std::max(numbers[0].back(), numbers[1].back());
    if (static_cast<std::int64_t>(times.size()) > last + 1) {
      source.notes.push_back("times.txt holds " + std::to_string(times.size()) +
                             " times; the last image is number " + std::to_string(last));
    }
  } else if (counted) {
    source.times_assumed = !options.rate;
    if (source.times_assumed) {
      source.notes.push_back("no times.txt: 10 Hz assumed; --rate HZ states another");
    }
    // (At 10 Hz as 0.1 k, not k / 10: the last bits of stamps.)
    const double period = options.rate ? 1.0 / *options.rate : 0.1;
    for (int i = 0; i < 2; ++i) {
      for (const std::int64_t k : numbers[i]) stamps[i].push_back(period * static_cast<double>(k));
    }
  } else {
    const auto unit = images[0].decimal ? StampUnit{1e-9, "s"} : stamp_unit(numbers[0]);
    if (!unit) {
      source.missing.push_back(folders[0] +
                               ": numbers that are neither counted frames nor stamps, as in no "
                               "unit they come 0.2 to 200 times a second; expected times.txt, one "
                               "time [s] a line");
      return source;
    }
    source.notes.push_back("names are stamps, in " + std::string(unit->name) +
                           (images[0].decimal ? "" : ", by their rate"));
    for (int i = 0; i < 2; ++i) {
      for (const std::int64_t k : numbers[i]) {
        stamps[i].push_back(static_cast<double>(k) * unit->seconds);
      }
    }
  }
  for (int i = 0; i < 2; ++i) {
    (i == 0 ? source.left : source.right) =
        image_files(folders[i], std::move(stamps[i]), std::move(paths[i]));
  }
  source.attempt([&] {
    const std::string poses = timed || counted ? kitti_poses(path) : "";
    const std::string tum = path + "/groundtruth.txt";
    if (!poses.empty()) {
      const std::vector<Eigen::Isometry3d> all = read_kitti_poses(poses, source.notes);
      const std::vector<std::size_t> lines =
          lines_of_images(numbers[0], all.size(), poses, source.notes);
      for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!is_known(all[lines[i]])) continue;
        // Of camera 0, whichever pair is used.
        source.truth.push_back({source.left.stamps[i], all[lines[i]]});
        source.truth.back().T.translate(left_position);
      }
    } else if (fs::exists(tum)) {
      source.truth = read_tum_trajectory(tum, source.notes);
      source.truth_of_quaternions = true;
    }
  });
  return source;
}

bool is_video_pair(const std::string& path) {
  std::error_code error;
  std::string videos[2];
  return std::filesystem::is_directory(path, error)
             ? find_folders(path) == nullptr && find_videos(path, videos) != nullptr
             : is_video_name(path) && std::filesystem::exists(path, error);
}

StereoSource open_video_pair(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  StereoSource source;
  source.layout = "videos";
  const bool side_by_side = !fs::is_directory(path);
  const std::string above = fs::path(path).parent_path().string();
  const std::string folder = !side_by_side ? path : above.empty() ? "." : above;
  std::string videos[2];
  const FolderNames* found = side_by_side ? nullptr : find_videos(folder, videos);
  find_calibration(folder, found != nullptr ? *found : kFolderNames[3], options, source);
  source.attempt([&] {
    if (side_by_side) {
      std::tie(source.left, source.right) = side_by_side_images(path, source.notes);
      source.notes.push_back("one video: the left and right halves of its frames are the pair");
    } else {
      source.left = video_images(videos[0], source.notes);
      source.right = video_images(videos[1], source.notes);
    }
  });
  // Not KITTI's poses: they are counted by frames, and a damaged video lacks some.
  const std::string truth = folder + "/groundtruth.txt";
  if (fs::exists(truth)) {
    source.attempt([&] { source.truth = read_tum_trajectory(truth, source.notes); });
    source.truth_of_quaternions = true;
  }
  return source;
}

}  // namespace prospect

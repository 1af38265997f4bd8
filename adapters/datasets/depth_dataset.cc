#include "adapters/datasets/depth_dataset.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "adapters/datasets/number_text.h"
#include "adapters/datasets/numbered_files.h"
#include "adapters/datasets/trajectory.h"
#include "adapters/files/checked_png.h"
#include "adapters/files/input_error.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostPixels = 100'000'000;
constexpr double kAssumedRate = 30.0;    // [Hz]
constexpr double kTumUnit = 1.0 / 5000;  // [m]
constexpr double kSameTime = 0.02;       // [s]

cv::Mat decode_depth(const std::string& path) {
  std::string png = checked_png(path, read_whole_file(path), kMostPixels);
  cv::Mat image;
  try {
    image = cv::imdecode(cv::Mat(1, static_cast<int>(png.size()), CV_8UC1, png.data()),
                         cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw InputError(path + ": cannot be decoded; expected an image");
  if (image.type() != CV_16UC1) {
    throw InputError(path + ": not of 16 bits a pixel; expected a depth image, 16-bit grey");
  }
  return image;
}

/// A matrix of `columns` numbers a line; empty lines are skipped.
Eigen::MatrixXd read_matrix(const std::string& path, int rows, int columns,
                            const std::string& expected) {
  Eigen::MatrixXd matrix(rows, columns);
  std::istringstream text(read_whole_file(path));
  std::string line;
  std::vector<double> numbers;
  int row = 0;
  for (int n = 1; std::getline(text, line); ++n) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (row == rows || !parse_numbers(line, numbers) ||
        static_cast<int>(numbers.size()) != columns) {
      throw InputError(path + ":" + std::to_string(n) + ": not a row of it; expected " + expected);
    }
    for (int c = 0; c < columns; ++c) matrix(row, c) = numbers[static_cast<std::size_t>(c)];
    ++row;
  }
  if (row < rows) {
    throw InputError(path + ": ends after " + std::to_string(row) + " rows; expected " + expected);
  }
  return matrix;
}

Eigen::Isometry3d read_pose(const std::string& path) {
  const Eigen::Matrix4d M = read_matrix(path, 4, 4, "a pose, 4 rows of 4 numbers, camera to world");
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0 ||
      (M.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 1e-6) {
    throw InputError(path + ": not a rotation and translation; expected a pose, camera to world");
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  T.translation() = M.topRightCorner<3, 1>();
  return T;
}

PinholeCamera read_intrinsics(const std::string& path) {
  const Eigen::MatrixXd K = read_matrix(path, 3, 3, "intrinsics, 3 rows of 3 numbers");
  if (!(K(0, 0) > 0.0 && K(1, 1) > 0.0) || K(0, 1) != 0.0 || K(1, 0) != 0.0 || K(2, 0) != 0.0 ||
      K(2, 1) != 0.0 || K(2, 2) != 1.0) {
    throw InputError(path + ": not of the form [fx 0 cx; 0 fy cy; 0 0 1]; expected intrinsics");
  }
  PinholeCamera camera;
  camera.fx = K(0, 0);
  camera.fy = K(1, 1);
  camera.cx = K(0, 2);
  camera.cy = K(1, 2);
  return camera;
}

}  // namespace

DepthDataset DepthDataset::open(const std::string& folder, const DepthDatasetOptions& options) {
  std::error_code error;
  const std::string layouts = "7-Scenes, TUM RGB-D or depth/NNN.png layout";
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder + ": no such folder; expected a recording in " + layouts);
  }
  DepthDataset dataset;
  dataset.range_ = options.range;
  bool frames = false;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    frames = frames || entry.path().filename().string().ends_with(".depth.png");
  }
  if (fs::exists(folder + "/depth.txt")) {
    dataset.open_tum(folder);
  } else if (frames) {
    dataset.open_seven_scenes(folder);
  } else if (fs::is_directory(folder + "/depth", error)) {
    dataset.open_numbered(folder);
  } else {
    throw InputError(folder +
                     ": neither depth.txt, nor frame-NNNNNN.depth.png, nor a folder depth" +
                     " is there; expected a recording in " + layouts);
  }
  const std::string intrinsics = folder + "/camera-intrinsics.txt";
  std::string where = intrinsics;
  if (fs::exists(intrinsics)) {
    if (options.camera) {
      throw InputError(intrinsics + ": states the intrinsics; expected no others beside it");
    }
    dataset.camera_ = read_intrinsics(intrinsics);
  } else if (options.camera) {
    dataset.camera_ = *options.camera;
    where = folder;
  } else {
    throw InputError(folder +
                     ": no file states the camera's intrinsics; expected camera-intrinsics.txt, or "
                     "--camera FX FY CX CY");
  }
  const cv::Mat first = decode_depth(dataset.images_[0]);
  PinholeCamera& camera = dataset.camera_;
  camera.width = first.cols;
  camera.height = first.rows;
  if (!(camera.cx > 0.25 * camera.width && camera.cx < 0.75 * camera.width &&
        camera.cy > 0.25 * camera.height && camera.cy < 0.75 * camera.height)) {
    throw InputError(where + ": the principal point is (" + number_text(camera.cx) + ", " +
                     number_text(camera.cy) + ") but the images have " + number_text(camera.width) +
                     " x " + number_text(camera.height) + " pixels; expected it near their centre");
  }
  return dataset;
}

void DepthDataset::open_seven_scenes(const std::string& folder) {
  layout_ = "7-Scenes";
  times_assumed_ = true;
  const auto files = numbered_files(folder, "frame-", ".depth.png");
  std::string first_without;
  for (const auto& [n, path] : files) {
    const std::string pose =
        path.substr(0, path.size() - std::string("depth.png").size()) + "pose.txt";
    images_.push_back(path);
    stamps_.push_back(static_cast<double>(n) / kAssumedRate);
    if (fs::exists(pose)) {
      poses_.push_back(read_pose(pose));
    } else if (first_without.empty()) {
      first_without = pose;
    }
  }
  if (!poses_.empty() && !first_without.empty()) {
    throw InputError(first_without +
                     ": no such file, but other frames have a pose; expected one "
                     "for each, or none");
  }
}

void DepthDataset::open_tum(const std::string& folder) {
  layout_ = "TUM RGB-D";
  unit_ = kTumUnit;
  const std::string list = folder + "/depth.txt";
  std::istringstream text(read_whole_file(list));
  std::string line;
  std::vector<double> stamp;
  std::vector<double> stamps;
  std::vector<std::string> images;
  for (int n = 1; std::getline(text, line); ++n) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    const auto space = line.find(' ');
    const std::string where = list + ":" + std::to_string(n);
    if (space == std::string::npos || !parse_numbers(line.substr(0, space), stamp) ||
        stamp.size() != 1) {
      throw InputError(where + ": not a frame; expected 'stamp path'");
    }
    if (!stamps.empty() && !(stamp[0] > stamps.back())) {
      throw InputError(where + ": the stamp does not increase; expected increasing stamps");
    }
    const std::string path = folder + "/" + line.substr(line.find_first_not_of(' ', space));
    if (!fs::exists(path)) throw InputError(where + ": " + path + " is absent; expected an image");
    stamps.push_back(stamp[0]);
    images.push_back(path);
  }
  if (images.empty()) throw InputError(list + ": holds no frame; expected 'stamp path' lines");
  const std::string truth_path = folder + "/groundtruth.txt";
  if (!fs::exists(truth_path)) {
    stamps_ = std::move(stamps);
    images_ = std::move(images);
    return;
  }
  const Trajectory truth = read_tum_trajectory(truth_path);
  for (std::size_t i = 0; i < images.size(); ++i) {
    auto next = std::lower_bound(truth.begin(), truth.end(), stamps[i],
                                 [](const TimedPose& p, double t) { return p.stamp < t; });
    if (next == truth.end() ||
        (next != truth.begin() && stamps[i] - (next - 1)->stamp < next->stamp - stamps[i])) {
      --next;
    }
    if (std::abs(next->stamp - stamps[i]) > kSameTime) {
      ++without_pose_;
      continue;
    }
    stamps_.push_back(stamps[i]);
    images_.push_back(images[i]);
    poses_.push_back(next->T);
  }
  if (images_.empty()) {
    throw InputError(truth_path + ": has no pose within 0.02 s of a frame; expected the times of " +
                     list);
  }
}

void DepthDataset::open_numbered(const std::string& folder) {
  layout_ = "numbered";
  times_assumed_ = true;
  for (const auto& [n, path] : numbered_files(folder + "/depth", "", ".png")) {
    images_.push_back(path);
    stamps_.push_back(static_cast<double>(n) / kAssumedRate);
  }
}

DepthImage DepthDataset::read(int i) const {
  const std::string& path = images_[static_cast<std::size_t>(i)];
  const cv::Mat raw = decode_depth(path);
  if (raw.cols != camera_.width || raw.rows != camera_.height) {
    throw InputError(path + ": has " + std::to_string(raw.cols) + " x " + std::to_string(raw.rows) +
                     " pixels, the first image " + number_text(camera_.width) + " x " +
                     number_text(camera_.height) + "; expected the same");
  }
  return depth_image(raw.ptr<std::uint16_t>(), raw.cols, raw.rows,
                     static_cast<std::ptrdiff_t>(raw.step1()), unit_, range_);
}

}  // namespace prospect

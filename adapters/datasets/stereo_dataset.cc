#include "adapters/datasets/stereo_dataset.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "adapters/datasets/number_text.h"
#include "adapters/datasets/numbered_files.h"
#include "adapters/files/input_error.h"
#include "adapters/files/strict_yaml.h"
#include "perception/stereo_check.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr double kMinBaseline = 0.01, kMaxBaseline = 2.0;  // [m]

struct PairedImages {
  std::vector<std::uint64_t> numbers;
  std::vector<std::string> left, right;
  int unpaired = 0;
};

PairedImages pair_images(const std::string& left_folder, const std::string& right_folder) {
  const auto left = numbered_files(left_folder, "", ".png"),
             right = numbered_files(right_folder, "", ".png");
  PairedImages paired;
  std::string first_alone;
  auto l = left.begin();
  auto r = right.begin();
  while (l != left.end() || r != right.end()) {
    if (r == right.end() || (l != left.end() && l->first < r->first)) {
      if (first_alone.empty()) first_alone = l->second;
      ++paired.unpaired;
      ++l;
    } else if (l == left.end() || r->first < l->first) {
      if (first_alone.empty()) first_alone = r->second;
      ++paired.unpaired;
      ++r;
    } else {
      paired.numbers.push_back(l->first);
      paired.left.push_back(l->second);
      paired.right.push_back(r->second);
      ++l;
      ++r;
    }
  }
  if (5 * paired.unpaired > static_cast<int>(paired.numbers.size()) + paired.unpaired) {
    throw InputError(first_alone + ": the other camera has no such image, and " +
                     std::to_string(paired.unpaired - 1) +
                     " more are alone; expected the same names for both cameras");
  }
  return paired;
}

Image decode_grey(const std::string& path) {
  const cv::Mat image = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw InputError(path + ": cannot be decoded; expected an image");
  Image out(image.cols, image.rows);
  for (int v = 0; v < image.rows; ++v) {
    std::copy_n(image.ptr<std::uint8_t>(v), image.cols,
                out.pixels.data() + static_cast<std::size_t>(v) * image.cols);
  }
  return out;
}

void check_baseline(const std::string& where, double baseline) {
  if (baseline < 0.0) {
    throw InputError(where + ": the right camera is " + number_text(-baseline) +
                     " m to the left of the left one: they look exchanged; expected it on the "
                     "right");
  }
  if (!(baseline >= kMinBaseline && baseline <= kMaxBaseline)) {
    throw InputError(where + ": the baseline is " + number_text(baseline) + " m; expected " +
                     number_text(kMinBaseline) + " to " + number_text(kMaxBaseline) + " m");
  }
}

/// The principal point lies near the centre of an image of the right size.
void check_size(const std::string& where, const PinholeCamera& camera) {
  if (!(camera.cx > 0.25 * camera.width && camera.cx < 0.75 * camera.width &&
        camera.cy > 0.25 * camera.height && camera.cy < 0.75 * camera.height)) {
    throw InputError(where + ": the principal point is (" + number_text(camera.cx) + ", " +
                     number_text(camera.cy) + ") but the images have " + number_text(camera.width) +
                     " x " + number_text(camera.height) + " pixels; expected it near their centre");
  }
}

CalibratedCamera read_sensor(const std::string& path) {
  std::string text = read_whole_file(path);
  // OpenCV's directive is not YAML's; the lines keep their numbers.
  if (!text.empty() && text[0] == '%') text.insert(0, "#");
  StrictYaml yaml = StrictYaml::from_text(text, path);
  YamlMap root = yaml.root();
  root.choice("sensor_type", "camera", {"camera"}, "kind of sensor");
  root.text("comment", "none", "free text");
  root.number("rate_hz", 20.0, 0.01, 10000.0, "Hz", "frame rate");
  root.required_choice("camera_model", {"pinhole"}, "projection");
  root.required_choice("distortion_model", {"radial-tangential"}, "distortion");
  CalibratedCamera camera;
  const auto resolution = root.required_numbers("resolution", 2, 16, 16384, "px", "width, height");
  const auto intrinsics = root.required_numbers("intrinsics", 4, 1, 100000, "px", "fu, fv, cu, cv");
  const auto distortion =
      root.required_numbers("distortion_coefficients", 4, -10, 10, "1", "k1, k2, p1, p2");
  YamlMap T = root.map("T_BS");
  T.integer("cols", 4, 4, 4, "1", "columns");
  T.integer("rows", 4, 4, 4, "1", "rows");
  const auto data = T.required_numbers("data", 16, -1000, 1000, "1", "camera to body, by rows");
  yaml.finish();
  camera.pinhole = {intrinsics[0], intrinsics[1], intrinsics[2],
                    intrinsics[3], resolution[0], resolution[1]};
  std::copy_n(distortion.begin(), 4, camera.distortion.begin());
  Eigen::Matrix4d M;
  for (int i = 0; i < 16; ++i) M(i / 4, i % 4) = data[i];
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0 ||
      M.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw InputError(path + ": T_BS is not a rotation and translation; expected one");
  }
  camera.T_BC.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  camera.T_BC.translation() = M.topRightCorner<3, 1>();
  return camera;
}

}  // namespace

StereoDataset StereoDataset::open(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder + ": no such folder; expected a recording in KITTI or EuRoC layout");
  }
  StereoDataset dataset;
  if (fs::exists(folder + "/calib.txt")) {
    dataset.open_kitti(folder);
  } else if (fs::exists(folder + "/mav0")) {
    dataset.open_euroc(folder);
  } else if (fs::exists(folder + "/rgb.txt") || fs::exists(folder + "/depth.txt")) {
    throw InputError(folder +
                     ": a recording of one camera and depth (TUM RGB-D); expected a stereo "
                     "pair in KITTI or EuRoC layout");
  } else {
    throw InputError(folder +
                     ": neither calib.txt (KITTI) nor mav0 (EuRoC) is there; expected a "
                     "recording in one of these layouts");
  }
  dataset.check_first_pair(folder);
  return dataset;
}

void StereoDataset::open_kitti(const std::string& folder) {
  layout_ = "KITTI";
  const std::string calibration = folder + "/calib.txt";
  std::vector<std::vector<double>> rows(2);
  std::istringstream text(read_whole_file(calibration));
  std::string line;
  int unnamed = 0;
  for (int n = 1; std::getline(text, line); ++n) {
    std::string name;
    const auto colon = line.find(':');
    if (colon != std::string::npos) {
      name = line.substr(0, colon);
      line.erase(0, colon + 1);
    }
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    int which = -1;
    if (name.empty()) {
      which = unnamed++;
    } else if (name == "P0" || name == "P1") {
      which = name[1] - '0';
    }
    if (which < 0 || which > 1) continue;  // the colour cameras, the laser scanner
    const std::string where = calibration + ":" + std::to_string(n);
    if (!parse_numbers(line, rows[which]) || rows[which].size() != 12) {
      throw InputError(where + ": not a projection matrix; expected twelve numbers");
    }
  }
  for (int i = 0; i < 2; ++i) {
    if (rows[i].empty()) {
      throw InputError(calibration + ": the projection matrix P" + std::to_string(i) +
                       " is missing; expected P0 and P1");
    }
  }
  const auto& P0 = rows[0];
  const auto& P1 = rows[1];
  for (const auto& P : rows) {
    if (!(P[0] > 0.0 && P[5] > 0.0) || P[1] != 0.0 || P[4] != 0.0 || P[8] != 0.0 || P[9] != 0.0 ||
        P[10] != 1.0) {
      throw InputError(calibration +
                       ": not of the form [f 0 cx tx; 0 f cy 0; 0 0 1 0]; expected "
                       "the projection of a rectified camera");
    }
  }
  if (std::abs(P0[0] - P1[0]) > 1e-6 * P0[0] || std::abs(P0[2] - P1[2]) > 1e-6 * P0[0] ||
      std::abs(P0[6] - P1[6]) > 1e-6 * P0[0]) {
    throw InputError(calibration +
                     ": P0 and P1 have different focal lengths or principal points; "
                     "expected a rectified pair");
  }
  camera_.left.fx = P0[0];
  camera_.left.fy = P0[5];
  camera_.left.cx = P0[2];
  camera_.left.cy = P0[6];
  camera_.baseline = (P0[3] - P1[3]) / P0[0];
  check_baseline(calibration, camera_.baseline);

  const bool named = fs::is_directory(folder + "/image_l");
  PairedImages images = pair_images(folder + (named ? "/image_l" : "/image_0"),
                                    folder + (named ? "/image_r" : "/image_1"));
  left_ = std::move(images.left);
  right_ = std::move(images.right);
  unpaired_ = images.unpaired;
  // Times and poses are by frame number, counted from the first file.
  std::vector<double> times;
  const std::string times_path = folder + "/times.txt";
  if (fs::exists(times_path)) {
    std::istringstream lines(read_whole_file(times_path));
    std::vector<double> numbers;
    for (int n = 1; std::getline(lines, line); ++n) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (!parse_numbers(line, numbers) || numbers.size() != 1 ||
          (!times.empty() && !(numbers[0] > times.back()))) {
        throw InputError(times_path + ":" + std::to_string(n) +
                         ": not an increasing time; expected one a line [s]");
      }
      times.push_back(numbers[0]);
    }
  } else {
    times_assumed_ = true;
    for (std::uint64_t k = 0; k <= images.numbers.back() && k < 1000000; ++k) {
      times.push_back(0.1 * static_cast<double>(k));
    }
  }
  for (const std::uint64_t k : images.numbers) {
    if (k >= times.size()) {
      throw InputError(times_path + ": holds " + std::to_string(times.size()) +
                       " times; expected one for image " + std::to_string(k));
    }
    stamps_.push_back(times[k]);
  }
  std::string poses = folder + "/poses.txt";
  if (!fs::exists(poses)) {
    const fs::path path = fs::absolute(folder + "/calib.txt").lexically_normal().parent_path();
    poses =
        (path.parent_path().parent_path() / "poses" / (path.filename().string() + ".txt")).string();
  }
  if (fs::exists(poses)) {
    times.resize(images.numbers.back() + 1);
    ground_truth_ = read_kitti_trajectory(poses, times);
  }
}

void StereoDataset::open_euroc(const std::string& folder) {
  layout_ = "EuRoC";
  const std::string cameras[2] = {folder + "/mav0/cam0", folder + "/mav0/cam1"};
  const CalibratedCamera left = read_sensor(cameras[0] + "/sensor.yaml");
  const CalibratedCamera right = read_sensor(cameras[1] + "/sensor.yaml");
  check_size(cameras[0] + "/sensor.yaml", left.pinhole);
  check_size(cameras[1] + "/sensor.yaml", right.pinhole);
  try {
    rectification_ = std::make_shared<const Rectification>(left, right);
  } catch (const std::invalid_argument& problem) {
    throw InputError(cameras[1] + "/sensor.yaml: " + problem.what());
  }
  camera_ = rectification_->camera();
  check_baseline(cameras[1] + "/sensor.yaml", camera_.baseline);
  PairedImages images = pair_images(cameras[0] + "/data", cameras[1] + "/data");
  left_ = std::move(images.left);
  right_ = std::move(images.right);
  unpaired_ = images.unpaired;
  for (const std::uint64_t ns : images.numbers) stamps_.push_back(static_cast<double>(ns) * 1e-9);

  Trajectory body;
  const std::string csv = folder + "/mav0/state_groundtruth_estimate0/data.csv";
  const std::string tum = folder + "/groundtruth_tum.txt";
  if (fs::exists(tum)) {
    body = read_tum_trajectory(tum);
  } else if (fs::exists(csv)) {
    // ns, position, quaternion (w first), and more that is not needed.
    std::istringstream lines(read_whole_file(csv));
    std::string line;
    std::vector<double> n;
    for (int k = 1; std::getline(lines, line); ++k) {
      if (line.empty() || line[0] == '#' || line == "\r") continue;
      if (!parse_numbers(line, n) || n.size() < 8 ||
          std::abs(Eigen::Vector4d(n[4], n[5], n[6], n[7]).norm() - 1.0) > 0.01 ||
          (!body.empty() && !(n[0] * 1e-9 > body.back().stamp))) {
        throw InputError(csv + ":" + std::to_string(k) +
                         ": not a pose; expected time [ns], position, quaternion (w first)");
      }
      TimedPose pose{n[0] * 1e-9, Eigen::Isometry3d::Identity()};
      pose.T.linear() = Eigen::Quaterniond(n[4], n[5], n[6], n[7]).normalized().toRotationMatrix();
      pose.T.translation() << n[1], n[2], n[3];
      body.push_back(pose);
    }
  }
  for (TimedPose& pose : body) pose.T = pose.T * rectification_->T_BC();
  ground_truth_ = std::move(body);
}

void StereoDataset::check_first_pair(const std::string& folder) {
  // Sizes, decoding and rectification of the first pair; then what the images themselves say.
  Image left = decode_grey(left_[0]), right = decode_grey(right_[0]);
  if (left.width != right.width || left.height != right.height) {
    throw InputError(right_[0] + ": has " + std::to_string(right.width) + " x " +
                     std::to_string(right.height) + " pixels, the left image " +
                     std::to_string(left.width) + " x " + std::to_string(left.height) +
                     "; expected the same");
  }
  if (!rectification_) {  // calib.txt does not say the size
    camera_.left.width = left.width;
    camera_.left.height = left.height;
    check_size(folder + "/calib.txt", camera_.left);
  } else if (left.width != camera_.left.width || left.height != camera_.left.height) {
    throw InputError(left_[0] + ": has " + std::to_string(left.width) + " x " +
                     std::to_string(left.height) + " pixels, the calibration is for " +
                     number_text(camera_.left.width) + " x " + number_text(camera_.left.height) +
                     "; expected the same");
  }
  // A pair that is dark or blurred says nothing: ask a few along the recording.
  for (const int i : {0, size() / 2, size() - 1}) {
    const Pair pair = read(i);
    const std::string complaint =
        stereo_complaint(check_stereo(pair.left.view(), pair.right.view()));
    if (complaint.empty()) return;
    if (i == size() - 1 || size() == 1) throw InputError(right_[0] + ": " + complaint);
  }
}

StereoDataset::Pair StereoDataset::read(int i) const {
  Pair pair{decode_grey(left_[i]), decode_grey(right_[i])};
  for (const auto& [image, path] :
       {std::pair(&pair.left, &left_[i]), std::pair(&pair.right, &right_[i])}) {
    if (image->width != camera_.left.width || image->height != camera_.left.height) {
      throw InputError(*path + ": has " + std::to_string(image->width) + " x " +
                       std::to_string(image->height) + " pixels, the first image " +
                       number_text(camera_.left.width) + " x " + number_text(camera_.left.height) +
                       "; expected the same");
    }
  }
  if (rectification_) {
    pair.left = rectification_->left(pair.left.view());
    pair.right = rectification_->right(pair.right.view());
  }
  return pair;
}

}  // namespace prospect

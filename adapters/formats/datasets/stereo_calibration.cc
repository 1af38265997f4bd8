// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/stereo_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "adapters/formats/datasets/camera_window.h"
#include "adapters/formats/datasets/kitti_raw_calibration.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/datasets/zed_calibration.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/loose_yaml.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

constexpr double kMinBaseline = 0.01, kMaxBaseline = 2.0;  // [m]

Eigen::Matrix3d by_rows(const std::vector<double>& n) {
  Eigen::Matrix3d M;
  for (int i = 0; i < 9; ++i) M(i / 3, i % 3) = n[static_cast<std::size_t>(i)];
  return M;
}

PinholeCamera pinhole_of(const std::string& where, const std::vector<double>& K, double width,
                         double height) {
  if (!(K[0] > 0.0 && K[4] > 0.0) || std::abs(K[1]) > 1e-3 * K[0] || K[8] != 1.0) {
    throw InputError(where + ": not of the form [fx 0 cx; 0 fy cy; 0 0 1]; expected intrinsics");
  }
  return {K[0], K[4], K[2], K[5], width, height};
}

void use_lens(CalibratedCamera& camera, const std::string& where, const std::string& model,
              const std::vector<double>& coefficients) {
  const std::string problem = set_lens(camera, model, coefficients);
  if (!problem.empty()) throw InputError(where + ": " + problem);
}

CameraInfo read_camera_info(const LooseYaml& yaml, const std::string& from) {
  CameraInfo info;
  // Of files, of `ros2 topic echo`, of `rostopic echo`.
  const auto key = [&](const std::vector<std::string>& keys) {
    const std::string found = yaml.first_of(keys);
    return found.empty() ? keys[0] : found;
  };
  const std::string width = yaml.first_of({"image_width", "width"});
  const std::string height = yaml.first_of({"image_height", "height"});
  if (!width.empty()) info.width = yaml.number(width);
  if (!height.empty()) info.height = yaml.number(height);
  info.model = yaml.text("distortion_model", "plumb_bob");
  info.K = yaml.numbers(key({"camera_matrix", "K", "k"}), 9);
  const std::string D = yaml.first_of({"distortion_coefficients", "D", "d"});
  if (!D.empty()) info.D = yaml.numbers(D);
  const std::string R = yaml.first_of({"rectification_matrix", "R", "r"});
  info.R = R.empty() ? std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1} : yaml.numbers(R, 9);
  const std::string P = yaml.first_of({"projection_matrix", "P", "p"});
  if (!P.empty()) info.P = yaml.numbers(P, 12);
  CameraWindow window;
  const auto read = [](const LooseYaml& map, const char* key, double& value) {
    if (map.has(key)) value = map.number(key);
  };
  read(yaml, "binning_x", window.binning_x);
  read(yaml, "binning_y", window.binning_y);
  if (yaml.has("roi")) {
    const LooseYaml roi = yaml.at("roi");
    read(roi, "x_offset", window.x_offset);
    read(roi, "y_offset", window.y_offset);
    read(roi, "width", window.width);
    read(roi, "height", window.height);
  }
  return of_images(std::move(info), window, from);
}

const std::vector<std::string> kCameraMatrix[2] = {
    {"M1", "K1", "cameraMatrix1", "camera_matrix_1", "LEFT.K"},
    {"M2", "K2", "cameraMatrix2", "camera_matrix_2", "RIGHT.K"}};
const std::vector<std::string> kDistortion[2] = {
    {"D1", "distCoeffs1", "dist_coeffs_1", "distortion_coefficients_1", "LEFT.D"},
    {"D2", "distCoeffs2", "dist_coeffs_2", "distortion_coefficients_2", "RIGHT.D"}};

StereoCalibration read_opencv(const LooseYaml& intrinsics, const LooseYaml& extrinsics,
                              const std::string& from) {
  StereoCalibration out;
  CalibratedCamera* const cameras[2] = {&out.left, &out.right};
  std::string model = intrinsics.text("distortion_model", "");
  if (model.empty()) {
    model = "radial-tangential";
    out.notes.push_back(from + ": states no distortion_model: taken as radial-tangential");
  }
  double width = 0.0, height = 0.0;
  const std::string size = intrinsics.first_of({"image_size", "imageSize", "size"});
  if (!size.empty()) {
    const auto n = intrinsics.numbers(size, 2);
    width = n[0];
    height = n[1];
  } else if (intrinsics.has("image_width") && intrinsics.has("image_height")) {
    width = intrinsics.number("image_width");
    height = intrinsics.number("image_height");
  }
  for (int i = 0; i < 2; ++i) {
    const std::string M = intrinsics.first_of(kCameraMatrix[i]);
    const std::string D = intrinsics.first_of(kDistortion[i]);
    if (M.empty()) {
      throw InputError(from + ": " + kCameraMatrix[i][0] +
                       " is missing; expected the cameras' matrices M1 and M2");
    }
    cameras[i]->pinhole = pinhole_of(intrinsics.where(M), intrinsics.numbers(M, 9), width, height);
    if (D.empty()) {
      out.notes.push_back(from + ": states no " + kDistortion[i][0] + ": no distortion");
    } else {
      use_lens(*cameras[i], intrinsics.where(D), model, intrinsics.numbers(D));
    }
  }
  const auto t = extrinsics.numbers("T", 3);
  const Eigen::Vector3d T(t[0], t[1], t[2]);
  if (T.norm() > kMaxBaseline && T.norm() <= 1000.0 * kMaxBaseline && T.norm() >= 10.0) {
    throw InputError(extrinsics.where("T") + ": T is " + number_text(T.norm()) +
                     " long, which would be millimetres; expected metres");
  }
  const std::string R = extrinsics.first_of({"R"});
  // x_right = R x_left + T; the body is the left camera.
  out.right.T_BC =
      checked_pose(T, by_rows(extrinsics.numbers(R.empty() ? "R" : R, 9)), extrinsics.where("R"))
          .inverse();
  return out;
}

CalibratedCamera read_kalibr_camera(const LooseYaml& yaml) {
  CalibratedCamera camera;
  const std::string model = yaml.text("camera_model", "pinhole");
  if (model != "pinhole") {
    throw InputError(yaml.where("camera_model") + ": camera_model is '" + model +
                     "'; expected pinhole, with radtan or equidistant distortion");
  }
  const auto n = yaml.numbers("intrinsics", 4);
  double width = 0.0, height = 0.0;
  if (yaml.has("resolution")) {
    const auto size = yaml.numbers("resolution", 2);
    width = size[0];
    height = size[1];
  }
  camera.pinhole =
      pinhole_of(yaml.where("intrinsics"), {n[0], 0, n[2], 0, n[1], n[3], 0, 0, 1}, width, height);
  const std::string D = yaml.first_of({"distortion_coeffs", "distortion_coefficients"});
  use_lens(camera, yaml.where("distortion_model"), yaml.text("distortion_model", "none"),
           D.empty() ? std::vector<double>() : yaml.numbers(D));
  return camera;
}

Eigen::Isometry3d read_transform(const LooseYaml& yaml, const std::string& key) {
  const auto n = yaml.numbers(key, 16);
  Eigen::Matrix4d M;
  for (int i = 0; i < 16; ++i) M(i / 4, i % 4) = n[static_cast<std::size_t>(i)];
  return checked_pose(M.topRightCorner<3, 1>(), Eigen::Matrix3d(M.topLeftCorner<3, 3>()),
                      yaml.where(key));
}

StereoCalibration read_camchain(const LooseYaml& yaml, const std::string& from) {
  if (!yaml.has("cam1")) {
    throw InputError(from + ": holds cam0 only; expected a camchain of two cameras, cam0 and cam1");
  }
  StereoCalibration out;
  const LooseYaml cam0 = yaml.at("cam0"), cam1 = yaml.at("cam1");
  out.left = read_kalibr_camera(cam0);
  out.right = read_kalibr_camera(cam1);
  if (cam1.has("T_cn_cnm1")) {
    out.right.T_BC = read_transform(cam1, "T_cn_cnm1").inverse();
  } else if (cam0.has("T_cam_imu") && cam1.has("T_cam_imu")) {
    out.left.T_BC = read_transform(cam0, "T_cam_imu").inverse();
    out.right.T_BC = read_transform(cam1, "T_cam_imu").inverse();
  } else {
    throw InputError(from + ": cam1 has no T_cn_cnm1; expected its pose with respect to cam0");
  }
  return out;
}

}  // namespace

std::string set_lens(CalibratedCamera& camera, const std::string& model,
                     const std::vector<double>& coefficients) {
  std::string name = model;
  std::replace(name.begin(), name.end(), '_', '-');
  std::vector<double> k = coefficients;
  const std::string count = std::to_string(k.size());
  camera.distortion = {};
  camera.lens = Lens::kRadialTangential;
  if (name == "none" || name.empty()) {
    if (std::any_of(k.begin(), k.end(), [](double value) { return value != 0.0; })) {
      return "states no distortion, but coefficients; expected the model's name";
    }
    return {};
  }
  if (name == "equidistant" || name == "fisheye" || name == "kannala-brandt4") {
    if (k.size() != 4) return "has " + count + " coefficients; expected 4 of an equidistant lens";
    camera.lens = Lens::kEquidistant;
  } else if (name == "radtan" || name == "radial-tangential" || name == "plumb-bob" ||
             name == "rational-polynomial") {
    // OpenCV's thin prism and tilt follow the rational terms.
    while (k.size() > 8 && k.back() == 0.0) k.pop_back();
    if (!k.empty() && k.size() != 4 && k.size() != 5 && k.size() != 8) {
      return "has " + count + " coefficients; expected 4, 5 or 8 (k1 k2 p1 p2 k3 k4 k5 k6)";
    }
  } else {
    return "the distortion model is '" + model +
           "'; expected radtan (radial-tangential, plumb_bob, rational_polynomial), equidistant "
           "(fisheye) or none";
  }
  std::copy(k.begin(), k.end(), camera.distortion.begin());
  return {};
}

std::string lens_name(const CalibratedCamera& camera) {
  if (camera.lens == Lens::kEquidistant) return "equidistant";
  const bool plain = std::all_of(camera.distortion.begin(), camera.distortion.end(),
                                 [](double k) { return k == 0.0; });
  return plain ? "none" : "radial-tangential";
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

void check_principal_point(const std::string& where, const PinholeCamera& camera) {
  if (!(camera.cx > 0.25 * camera.width && camera.cx < 0.75 * camera.width &&
        camera.cy > 0.25 * camera.height && camera.cy < 0.75 * camera.height)) {
    throw InputError(where + ": the principal point is (" + number_text(camera.cx) + ", " +
                     number_text(camera.cy) + ") but the images have " + number_text(camera.width) +
                     " x " + number_text(camera.height) + " pixels; expected it near their centre");
  }
}

StereoCalibration read_kitti_calibration(const std::string& path, int first,
                                         Eigen::Vector3d* left_position) {
  std::vector<std::vector<double>> rows(2);
  const auto name = [](int number) { return std::string("P").append(std::to_string(number)); };
  const std::string names[2] = {name(first), name(first + 1)};
  std::istringstream text(read_whole_file(path));
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
    } else if (name == names[0] || name == names[1]) {
      which = name == names[1];
    }
    if (which < 0 || which > 1) continue;  // the other cameras, the laser scanner
    if (!parse_numbers(line, rows[which]) || rows[which].size() != 12) {
      throw InputError(path + ":" + std::to_string(n) +
                       ": not a projection matrix; expected twelve numbers");
    }
  }
  for (int i = 0; i < 2; ++i) {
    if (rows[i].empty()) {
      throw InputError(path + ": the projection matrix " + names[i] + " is missing; expected " +
                       names[0] + " and " + names[1]);
    }
  }
  for (const auto& P : rows) {
    if (!(P[0] > 0.0 && P[5] > 0.0) || P[1] != 0.0 || P[4] != 0.0 || P[8] != 0.0 || P[9] != 0.0 ||
        P[10] != 1.0) {
      throw InputError(path +
                       ": not of the form [f 0 cx tx; 0 f cy 0; 0 0 1 0]; expected "
                       "the projection of a rectified camera");
    }
  }
  const auto& P0 = rows[0];
  const auto& P1 = rows[1];
  if (std::abs(P0[0] - P1[0]) > 1e-6 * P0[0] || std::abs(P0[2] - P1[2]) > 1e-6 * P0[0] ||
      std::abs(P0[6] - P1[6]) > 1e-6 * P0[0]) {
    throw InputError(path + ": " + names[0] + " and " + names[1] +
                     " have different focal lengths or principal points; "
                     "expected a rectified pair");
  }
  StereoCalibration out;
  out.from = path;
  out.rectified = true;
  out.camera.left.fx = P0[0];
  out.camera.left.fy = P0[5];
  out.camera.left.cx = P0[2];
  out.camera.left.cy = P0[6];
  out.camera.left.width = out.camera.left.height = 0.0;
  out.camera.baseline = ((P0[3] - P0[2] * P0[11]) - (P1[3] - P1[2] * P1[11])) / P0[0];
  if (left_position != nullptr) {
    *left_position = {-(P0[3] - P0[2] * P0[11]) / P0[0], -(P0[7] - P0[6] * P0[11]) / P0[5],
                      -P0[11]};
  }
  check_baseline(path, out.camera.baseline);
  return out;
}

PinholeCamera read_camera_info_pinhole(const std::string& path, std::vector<std::string>& notes) {
  const CameraInfo info = read_camera_info(LooseYaml::from_text(read_whole_file(path), path), path);
  return depth_camera_of(info, false, path, notes);
}

PinholeCamera depth_camera_of(const CameraInfo& info, bool rectified, const std::string& where,
                              std::vector<std::string>& notes) {
  if (rectified && info.P.size() == 12 && info.P[0] > 0.0) {
    const auto& P = info.P;
    return pinhole_of(where, {P[0], P[1], P[2], P[4], P[5], P[6], P[8], P[9], P[10]}, info.width,
                      info.height);
  }
  CalibratedCamera camera;
  camera.pinhole = pinhole_of(where, info.K, info.width, info.height);
  if (rectified) return camera.pinhole;
  use_lens(camera, where, info.model, info.D);
  const double width = info.width > 0.0 ? info.width : 2.0 * camera.pinhole.cx;
  const double height = info.height > 0.0 ? info.height : 2.0 * camera.pinhole.cy;
  double moved = 0.0;  // [px]
  for (int n = 0; n < 25; ++n) {
    const int column = n % 5, row = n / 5;
    const Eigen::Vector2d p(0.25 * column * width, 0.25 * row * height);
    const Eigen::Vector2d ray((p.x() - camera.pinhole.cx) / camera.pinhole.fx,
                              (p.y() - camera.pinhole.cy) / camera.pinhole.fy);
    moved = std::fmax(moved, (project_distorted(camera, ray) - p).norm());
  }
  constexpr double kSeen = 0.5, kTooMuch = 5.0;  // [px]
  const std::string states = "states a lens that moves pixels by up to " +
                             number_text(std::round(10.0 * moved) / 10.0) + " px";
  if (moved > kTooMuch) {
    throw InputError(where + ": " + states +
                     ", and nothing says that its depth images are rectified; expected rectified "
                     "ones, of a topic with rect in its name");
  }
  if (moved > kSeen) notes.push_back(where + ": " + states + ": depths are taken without it");
  return camera.pinhole;
}

Eigen::Isometry3d rectified_axes(const CameraInfo& info) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (info.R.size() != 9) return T;
  const Eigen::Matrix3d R = by_rows(info.R);
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.01 && R.determinant() > 0.0) {
    T.linear() = R.transpose();
  }
  return T;
}

bool is_named_rectified(const std::string& topic) {
  for (std::size_t at = 0; (at = topic.find("rect", at)) != std::string::npos; ++at) {
    if (at == 0 || topic[at - 1] == '/' || topic[at - 1] == '_') return true;  // not "/direct"
  }
  return false;
}

StereoCalibration calibration_of(const CameraInfo& left, const CameraInfo& right,
                                 const std::string& left_from, const std::string& right_from,
                                 bool rectified) {
  StereoCalibration out;
  out.from = right_from;
  for (const auto& [info, from] : {std::pair(&left, &left_from), std::pair(&right, &right_from)}) {
    if (info->P.size() != 12 || !(info->P[0] > 0.0)) {
      throw InputError(*from +
                       ": states no projection matrix (P); expected that of a stereo calibration");
    }
    const auto& P = info->P;
    const auto is_small = [&](double value) { return std::abs(value) <= 1e-6 * P[0]; };
    if (!(P[5] > 0.0) || !is_small(P[1]) || !is_small(P[4]) || !is_small(P[7]) || P[8] != 0.0 ||
        P[9] != 0.0 || P[10] != 1.0 || P[11] != 0.0) {
      throw InputError(*from +
                       ": P is not of the form [fx 0 cx tx; 0 fy cy 0; 0 0 1 0]; expected the "
                       "projection of a pair side by side");
    }
  }
  double baseline = left.P[3] / left.P[0] - right.P[3] / right.P[0];
  if (right.P[3] == 0.0 && left.P[3] == 0.0) {
    throw InputError(right_from +
                     ": P states no baseline (its fourth number is 0); expected -fx times the "
                     "baseline: the calibration of a pair, not of one camera");
  }
  if (right.P[3] == left.P[3]) {
    throw InputError(right_from + ": P has the same fourth number, " + number_text(right.P[3]) +
                     ", as that of " + left_from +
                     "; expected 0 for the left camera and -fx times the baseline for the right");
  }
  if (left.P[3] == 0.0 && right.P[3] > 0.0) {
    // As drivers of DepthAI and older ones of RealSense write it.
    baseline = -baseline;
    out.wrong_side = right_from + ": P states " + number_text(right.P[3]) +
                     " as its fourth number, where -fx times the baseline is due";
  }
  check_baseline(right_from, baseline);
  if (rectified) {
    out.rectified = true;
    const auto& P = left.P;
    if (std::abs(P[0] - right.P[0]) > 1e-6 * P[0] || std::abs(P[2] - right.P[2]) > 1e-6 * P[0] ||
        std::abs(P[5] - right.P[5]) > 1e-6 * P[0] || std::abs(P[6] - right.P[6]) > 1e-6 * P[0]) {
      throw InputError(right_from +
                       ": P has another focal length or principal point than the left one's; "
                       "expected a rectified pair");
    }
    out.camera.left = {P[0], P[5], P[2], P[6], left.width, left.height};
    out.camera.baseline = baseline;
    return out;
  }
  CalibratedCamera* const cameras[2] = {&out.left, &out.right};
  const CameraInfo* const infos[2] = {&left, &right};
  const std::string* const from[2] = {&left_from, &right_from};
  for (int i = 0; i < 2; ++i) {
    const CameraInfo& info = *infos[i];
    if (info.K.size() != 9 || info.R.size() != 9) {
      throw InputError(*from[i] + ": K or R is missing; expected both");
    }
    cameras[i]->pinhole = pinhole_of(*from[i], info.K, info.width, info.height);
    use_lens(*cameras[i], *from[i], info.model, info.D);
    // R turns the camera's rays into the rectified pair's frame, which is the body.
    cameras[i]->T_BC = checked_pose({i * baseline, 0.0, 0.0}, by_rows(info.R), *from[i]);
  }
  return out;
}

StereoCalibration of_size(const StereoCalibration& calibration, int width, int height) {
  const auto size_of = [](const StereoCalibration& c) {
    return c.rectified ? c.camera.left : c.left.pinhole;
  };
  std::string known;
  std::vector<const StereoCalibration*> all = {&calibration};
  for (const StereoCalibration& other : calibration.others) all.push_back(&other);
  for (const StereoCalibration* one : all) {
    const PinholeCamera size = size_of(*one);
    if (size.width == width && size.height == height) {
      StereoCalibration out = *one;
      out.others.clear();
      return out;
    }
    known += (known.empty() ? "" : ", ") + number_text(size.width) + " x " +
             number_text(size.height) + " px" + (one->rectified ? " rectified" : "");
  }
  throw InputError(calibration.from + ": is for images of " + known + ", but these have " +
                   std::to_string(width) + " x " + std::to_string(height) +
                   "; expected the calibration of these cameras");
}

StereoCalibration read_stereo_calibration(const std::string& files, bool rectified) {
  const auto comma = files.find(',');
  const std::string first = files.substr(0, comma);
  const std::string second = comma == std::string::npos ? "" : files.substr(comma + 1);
  const std::string text = read_whole_file(first);
  if (lower_case(first).ends_with(".conf")) return read_zed_calibration(first);
  if (is_kitti_raw_calibration(first)) return read_kitti_raw_calibration(first, 0);
  if (first.ends_with(".txt") || text.starts_with("P0:")) {
    return read_kitti_calibration(first, 0);
  }
  const LooseYaml yaml = LooseYaml::from_text(text, first);
  const std::string camera_info = yaml.first_of({"camera_matrix", "K", "k"});
  StereoCalibration out;
  if (yaml.has("cam0")) {
    out = read_camchain(yaml, first);
  } else if (!camera_info.empty() && yaml.has(camera_info)) {
    if (second.empty()) {
      throw InputError(first +
                       ": the camera_info of one camera; expected two, separated by a comma: "
                       "--calibration left.yaml,right.yaml");
    }
    return calibration_of(
        read_camera_info(yaml, first),
        read_camera_info(LooseYaml::from_text(read_whole_file(second), second), second), first,
        second, rectified);
  } else if (!yaml.first_of(kCameraMatrix[0]).empty()) {
    const LooseYaml extrinsics =
        second.empty() ? yaml : LooseYaml::from_text(read_whole_file(second), second);
    out = read_opencv(yaml, extrinsics, first);
  } else if (yaml.has("model_type")) {
    throw InputError(first + ": the calibration of one camera by the model " +
                     yaml.text("model_type", "") +
                     ", which is not supported (KITTI-360's fisheye cameras have such a file); "
                     "expected that of a pair, with radtan or equidistant distortion");
  } else {
    throw InputError(
        first +
        ": neither calib.txt (P0, P1), nor camera_info (camera_matrix, projection_matrix), nor "
        "OpenCV stereo (M1 D1 M2 D2 R T), nor Kalibr's camchain (cam0, cam1), nor a ZED's .conf; "
        "expected one of these");
  }
  out.from = first;
  if (rectified) {
    throw InputError(first +
                     ": describes cameras as they are, not a rectified pair; expected calib.txt or "
                     "camera_info with --rectified");
  }
  return out;
}

}  // namespace prospect

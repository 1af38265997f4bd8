// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/rectification.h"

namespace prospect {

/// How the two cameras of a recording see, as a file states it: of images that are rectified, or of
/// both cameras by themselves.
struct StereoCalibration {
  bool rectified = false;
  StereoCamera camera;           ///< if rectified; width and height 0: the file does not state them
  CalibratedCamera left, right;  ///< otherwise; a size of 0 likewise. T_BC to any common body
  std::string from;              ///< file or topics, for messages
  std::vector<std::string> notes;  ///< what was assumed or passed over, one line each
  /// Not empty: P says that the right camera is to the left, in this line; it is taken to be on the
  /// right, if the images agree.
  std::string wrong_side;
  /// What the file states for images of other sizes.
  std::vector<StereoCalibration> others;
};

/// Of a calibration with others the first one for images of this size [px]. Throws InputError if
/// none is.
StereoCalibration of_size(const StereoCalibration& calibration, int width, int height);

/// The forms that a calibration may have.
///   calib.txt      KITTI: P0 and P1, twelve numbers each (or P2 and P3, see
///                  read_kitti_calibration); or of its raw drives (kitti_raw_calibration.h)
///   camera_info    ROS: K, D, R, P of one camera a file; `left.yaml,right.yaml`
///   OpenCV stereo  `%YAML:1.0`, M1 D1 M2 D2 R T (or K1.., cameraMatrix1..), in one file, or two as
///                  OpenCV's own sample writes them: `intrinsics.yml,extrinsics.yml`
///   camchain       Kalibr: cam0 and cam1 with intrinsics, distortion, T_cn_cnm1
///   .conf          Stereolabs' of a ZED (zed_calibration.h)
/// `files`: one path, or two separated by a comma. `rectified` says that the images are rectified
/// already, by R and P of a camera_info.
/// Throws InputError, one line: what is missing or wrong, or that it is none of these.
StereoCalibration read_stereo_calibration(const std::string& files, bool rectified = false);

/// A KITTI calib.txt. `first`: 0 for the grey pair (P0, P1), 2 for the colour pair (P2, P3). Two
/// rows without names are P0 and P1. `T_left` gets the position of the left camera in camera 0's
/// frame, rotated as it [m].
StereoCalibration read_kitti_calibration(const std::string& path, int first,
                                         Eigen::Vector3d* left_position = nullptr);

/// One camera of a camera_info file: for depth images (depth_camera_of()). Width and height as
/// stated, or 0.
PinholeCamera read_camera_info_pinhole(const std::string& path, std::vector<std::string>& notes);

/// What a ROS camera_info, message or file, says of a camera's images.
struct CameraInfo {
  double width = 0.0, height = 0.0;
  std::string model;               ///< plumb_bob, rational_polynomial, equidistant
  std::vector<double> D, K, R, P;  ///< 9, 9 and 12 numbers, by rows

  bool operator==(const CameraInfo&) const = default;
};
/// The camera of depth images: by P if they are rectified and it is stated, else by K. A lens that
/// moves pixels of images that are not rectified is told in `notes`; InputError where it moves them
/// by more than 5 px, or K or P is not that of a camera. `where` stands for the message or file.
PinholeCamera depth_camera_of(const CameraInfo& info, bool rectified, const std::string& where,
                              std::vector<std::string>& notes);
/// The rectified camera in the frame of the camera itself, by R; the identity where that is no
/// rotation.
Eigen::Isometry3d rectified_axes(const CameraInfo& info);

/// By its name a topic has rectified images: "/left/image_rect_raw".
bool is_named_rectified(const std::string& topic);

/// The pair that two of them describe.
StereoCalibration calibration_of(const CameraInfo& left, const CameraInfo& right,
                                 const std::string& left_from, const std::string& right_from,
                                 bool rectified);

/// Sets lens and distortion by a model's name in ROS, Kalibr, EuRoC or OpenCV (`radtan`,
/// `radial-tangential`, `plumb_bob`, `rational_polynomial`, `equidistant`, `fisheye`, `none`).
/// Empty, or what is wrong, "what; expected what".
std::string set_lens(CalibratedCamera& camera, const std::string& model,
                     const std::vector<double>& coefficients);
/// "radial-tangential", "equidistant" or "none".
std::string lens_name(const CalibratedCamera& camera);

/// Throws InputError unless it is 0.01 to 2 m and to the right. `where` stands for the file.
void check_baseline(const std::string& where, double baseline);
/// Throws InputError unless the principal point lies near the centre of the image.
void check_principal_point(const std::string& where, const PinholeCamera& camera);

}  // namespace prospect

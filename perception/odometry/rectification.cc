// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/rectification.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "models/parameter_check.h"

namespace prospect {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWidestRay = 85.0 * M_PI / 180.0;  // of a fisheye, from the axis [rad]
const double kWidestView = std::tan(50.0 * M_PI / 180.0);

double fisheye_radius(const std::array<double, 8>& k, double t) {
  const double s = t * t;
  return t * (1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))));
}

Vector2d distort(const CalibratedCamera& camera, const Vector2d& p) {
  const std::array<double, 8>& k = camera.distortion;
  const double x = p.x(), y = p.y(), s = x * x + y * y;
  if (camera.lens == Lens::kEquidistant) {
    const double r = std::sqrt(s);
    return r < 1e-9 ? p : Vector2d(p * (fisheye_radius(k, std::atan(r)) / r));
  }
  const double radial = (1.0 + k[0] * s + k[1] * s * s + k[4] * s * s * s) /
                        (1.0 + k[5] * s + k[6] * s * s + k[7] * s * s * s);
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (s + 2.0 * x * x),
          y * radial + k[2] * (s + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

void check(const CalibratedCamera& camera) {
  validate(camera.pinhole);
  // Files hold rotations of a few digits.
  const Matrix3d& R = camera.T_BC.linear();
  const double error = (R.transpose() * R - Matrix3d::Identity()).norm();
  check_parameter(error <= 0.01 && R.determinant() > 0.0, "camera",
                  "deviation of its rotation from an orthonormal matrix", error,
                  "a right-handed rotation, to 0.01");
  check_finite("camera", "position", camera.T_BC.translation().sum());
  for (const double k : camera.distortion) check_finite("camera", "distortion", k);
}

Image remap(const ImageView& image, const cv::Mat& x, const cv::Mat& y) {
  if (image.empty() || image.width != x.cols || image.height != x.rows) {
    throw std::invalid_argument("the image has " + std::to_string(image.width) + " x " +
                                std::to_string(image.height) + " pixels; expected " +
                                std::to_string(x.cols) + " x " + std::to_string(x.rows) +
                                ", as calibrated");
  }
  const cv::Mat from(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  Image out(x.cols, x.rows);
  cv::Mat to(x.rows, x.cols, CV_8U, out.pixels.data());
  cv::remap(from, to, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace

struct Rectification::Maps {
  cv::Mat left_x, left_y, right_x, right_y;
};

Vector2d project_distorted(const CalibratedCamera& camera, const Vector2d& ray) {
  const Vector2d d = distort(camera, ray);
  return {camera.pinhole.fx * d.x() + camera.pinhole.cx,
          camera.pinhole.fy * d.y() + camera.pinhole.cy};
}

Vector2d undistort(const CalibratedCamera& camera, const Vector2d& p) {
  const Vector2d target((p.x() - camera.pinhole.cx) / camera.pinhole.fx,
                        (p.y() - camera.pinhole.cy) / camera.pinhole.fy);
  if (camera.lens == Lens::kEquidistant) {
    // One equation of the angle, by bisection: the polynomial may turn back beyond the image.
    const double radius = target.norm();
    if (radius < 1e-9) return target;
    double low = 0.0, high = 0.0;
    while (high < kWidestRay && fisheye_radius(camera.distortion, high) < radius) {
      low = high;
      high += 0.02;
    }
    if (high >= kWidestRay) {
      return Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (fisheye_radius(camera.distortion, middle) < radius ? low : high) = middle;
    }
    return target * (std::tan(0.5 * (low + high)) / radius);
  }
  // Newton with a numerical Jacobian: fixed-point iteration does not settle at strong distortion.
  Vector2d x = target;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Vector2d r = distort(camera, x) - target;
    if (r.norm() < 1e-12) break;
    const double h = 1e-6;
    Matrix2d J;
    J.col(0) =
        (distort(camera, x + Vector2d(h, 0)) - distort(camera, x - Vector2d(h, 0))) / (2 * h);
    J.col(1) =
        (distort(camera, x + Vector2d(0, h)) - distort(camera, x - Vector2d(0, h))) / (2 * h);
    const Vector2d step = J.inverse() * r;
    if (!step.allFinite()) break;
    x -= step;
  }
  return x;
}

Rectification::Rectification(const CalibratedCamera& left, const CalibratedCamera& right) {
  check(left);
  check(right);
  if (left.pinhole.width != right.pinhole.width || left.pinhole.height != right.pinhole.height) {
    throw std::invalid_argument("the cameras' resolutions differ; expected the same");
  }
  const Vector3d baseline = right.T_BC.translation() - left.T_BC.translation();  // in B
  const double length = baseline.norm();
  if (!(length > 1e-3)) {
    throw std::invalid_argument("the baseline is " + std::to_string(length) +
                                " m; expected more than 0.001");
  }
  Matrix3d R_BN;  // new orientation
  R_BN.col(0) = baseline / length;
  const Vector3d forward = left.T_BC.linear().col(2) + right.T_BC.linear().col(2);
  const double sideways = left.T_BC.linear().col(0).dot(R_BN.col(0));
  if (sideways < -0.5) {
    throw std::invalid_argument(
        "the right camera is to the left of the left one: they look exchanged; expected it on the "
        "right");
  }
  if (sideways < std::cos(M_PI / 6)) {
    throw std::invalid_argument(
        "the baseline is not along the left image's rows; expected the cameras side by side");
  }
  R_BN.col(1) = forward.cross(R_BN.col(0)).normalized();
  R_BN.col(2) = R_BN.col(0).cross(R_BN.col(1));
  const Matrix3d R_left = R_BN.transpose() * left.T_BC.linear();  // left camera to new
  const Matrix3d R_right = R_BN.transpose() * right.T_BC.linear();

  // The widest view inside both images: their borders, seen in the new orientation.
  const double width = left.pinhole.width, height = left.pinhole.height;
  const bool fisheye = left.lens == Lens::kEquidistant || right.lens == Lens::kEquidistant;
  const double widest = fisheye ? kWidestView : 1e9;
  double x0 = -widest, x1 = widest, y0 = -widest, y1 = widest;
  const auto narrow = [&](const CalibratedCamera& camera, const Matrix3d& R) {
    const auto seen = [&](double u, double v) -> Vector2d {
      const Vector3d ray = R * undistort(camera, {u, v}).homogeneous();
      return ray.z() > 0.1 ? Vector2d(ray.hnormalized())
                           : Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    };
    for (int i = 0; i <= 40; ++i) {
      const double u = (width - 1.0) * i / 40, v = (height - 1.0) * i / 40;
      x0 = std::max(x0, seen(0.0, v).x());
      x1 = std::min(x1, seen(width - 1.0, v).x());
      y0 = std::max(y0, seen(u, 0.0).y());
      y1 = std::min(y1, seen(u, height - 1.0).y());
    }
  };
  narrow(left, R_left);
  narrow(right, R_right);
  if (!(x1 - x0 > 0.1 && y1 - y0 > 0.1)) {
    throw std::invalid_argument("the cameras share no view; expected them to look the same way");
  }
  const double f = std::max((width - 1.0) / (x1 - x0), (height - 1.0) / (y1 - y0));
  camera_.left.fx = camera_.left.fy = f;
  camera_.left.cx = 0.5 * (width - 1.0) - f * 0.5 * (x0 + x1);
  camera_.left.cy = 0.5 * (height - 1.0) - f * 0.5 * (y0 + y1);
  camera_.left.width = width;
  camera_.left.height = height;
  camera_.baseline = length;
  T_BC_.linear() = R_BN;
  T_BC_.translation() = left.T_BC.translation();

  const auto make = [&](const CalibratedCamera& camera, const Matrix3d& R, cv::Mat& x, cv::Mat& y) {
    x.create(static_cast<int>(height), static_cast<int>(width), CV_32F);
    y.create(x.rows, x.cols, CV_32F);
    for (int v = 0; v < x.rows; ++v) {
      for (int u = 0; u < x.cols; ++u) {
        const Vector3d ray =
            R.transpose() * Vector3d((u - camera_.left.cx) / f, (v - camera_.left.cy) / f, 1.0);
        const Vector2d p = project_distorted(camera, ray.hnormalized());
        x.at<float>(v, u) = static_cast<float>(p.x());
        y.at<float>(v, u) = static_cast<float>(p.y());
      }
    }
  };
  maps_ = std::make_unique<Maps>();
  make(left, R_left, maps_->left_x, maps_->left_y);
  make(right, R_right, maps_->right_x, maps_->right_y);
}
Rectification::~Rectification() = default;
Rectification::Rectification(Rectification&&) noexcept = default;
Rectification& Rectification::operator=(Rectification&&) noexcept = default;

Image Rectification::left(const ImageView& image) const {
  return remap(image, maps_->left_x, maps_->left_y);
}
Image Rectification::right(const ImageView& image) const {
  return remap(image, maps_->right_x, maps_->right_y);
}

}  // namespace prospect

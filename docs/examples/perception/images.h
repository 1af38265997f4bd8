// SPDX-License-Identifier: Apache-2.0
// Where images come from: your cameras' driver stands in its place.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "perception/odometry/rectification.h"
#include "perception/pipeline/perception_pipeline.h"

struct Frame {
  double stamp = 0.0;           // [s]
  prospect::Image left, right;  // as the cameras give them
  prospect::DepthImage depth;   // empty: there is no depth camera
};

struct Images {
  prospect::CalibratedCamera left, right;  // T_BC: where they sit on the body
  std::optional<prospect::DepthCameraOnBody> depth_camera;
  int size = 0;
  std::function<Frame(int)> read;
};

/// Pairs in a folder.
inline Images recorded_images(const std::string& folder) {
  Images images;
  std::ifstream calibration(folder + "/calib.txt"), times(folder + "/times.txt");
  std::string name;
  double P[2][12] = {};
  for (auto& row : P) {
    calibration >> name;
    for (double& number : row) calibration >> number;
  }
  if (!calibration || !(P[1][3] < 0.0)) {
    throw std::runtime_error(folder + "/calib.txt: expected P0 and P1 of a rectified pair");
  }
  std::vector<double> stamps;
  for (double stamp; times >> stamp;) stamps.push_back(stamp);
  if (stamps.empty()) throw std::runtime_error(folder + "/times.txt: expected a time [s] a line");
  const auto grey = [folder](int camera, int k) {
    char file[40];
    std::snprintf(file, sizeof file, "/image_%d/%06d.png", camera, k);
    const cv::Mat read = cv::imread(folder + file, cv::IMREAD_GRAYSCALE);
    if (read.empty()) throw std::runtime_error(folder + file + ": expected an image");
    prospect::Image image(read.cols, read.rows);
    std::copy(read.begin<std::uint8_t>(), read.end<std::uint8_t>(), image.pixels.begin());
    return image;
  };
  const prospect::Image first = grey(0, 0);
  images.left.pinhole = {P[0][0], P[0][5], P[0][2], P[0][6], 1.0 * first.width, 1.0 * first.height};
  images.left.T_BC = prospect::CameraMount::forward_facing({0.0, 0.0, 1.0});
  images.right = images.left;  // rectified: the same, moved along the rows
  images.right.T_BC.translate(Eigen::Vector3d(-P[1][3] / P[1][0], 0.0, 0.0));
  images.size = static_cast<int>(stamps.size());
  images.read = [stamps, grey](int k) {
    return Frame{stamps[static_cast<std::size_t>(k)], grey(0, k), grey(1, k), {}};
  };
  return images;
}

/// A room with texture on all surfaces, seen by a robot that drives a bend, eight images a second.
inline Images made_images() {
  Images images;
  images.left.pinhole = {190.0, 190.0, 121.0, 88.0, 240.0, 180.0};
  images.left.distortion = {-0.2, 0.03, 1e-4, -2e-4};
  images.left.T_BC = prospect::CameraMount::forward_facing({0.1, 0.05, 0.6}, 0.0, 0.25);
  images.right = images.left;
  images.right.pinhole.cx = 117.0;
  images.right.T_BC.translate(Eigen::Vector3d(0.1, 0.0, 0.0));
  images.right.T_BC.rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d(0.3, 1.0, 0.2).normalized()));
  images.depth_camera = {{130.0, 130.0, 79.5, 59.5, 160.0, 120.0},
                         {prospect::CameraMount::forward_facing({0.1, 0.0, 0.5}, 0.0, 0.3)}};
  images.size = 8;
  // The surface that a ray of a camera meets: its depth, and how bright it is there.
  struct Surface {
    double depth = 1e9, grey = 128.0;
  };
  const auto look = [](const Eigen::Isometry3d& T_WC, const Eigen::Vector3d& ray_in_C) {
    const Eigen::Vector3d low(-1.0, -1.6, 0.0), high(3.3, 1.9, 2.4), from = T_WC.translation();
    const Eigen::Vector3d ray = T_WC.linear() * ray_in_C;
    Surface seen;
    for (int i = 0; i < 3; ++i) {
      if (ray[i] != 0.0) {
        seen.depth = std::min(seen.depth, ((ray[i] > 0.0 ? high : low)[i] - from[i]) / ray[i]);
      }
    }
    // Waves that do not meet in the same way again.
    const Eigen::Vector3d point = from + seen.depth * ray;
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector3d wave(std::sin(7.0 * i), std::sin(11.0 * i + 1.0),
                                 std::sin(13.0 * i + 2.0));
      seen.grey += 16.0 * std::sin((12.0 + 7.0 * i) * wave.dot(point) + i);
    }
    return seen;
  };
  // Of each pixel of a camera.
  const auto rays_of = [](const prospect::CalibratedCamera& camera) {
    std::vector<Eigen::Vector3d> rays;
    for (int v = 0; v < camera.pinhole.height; ++v) {
      for (int u = 0; u < camera.pinhole.width; ++u) {
        rays.push_back(prospect::undistort(camera, Eigen::Vector2d(u, v)).homogeneous());
      }
    }
    return rays;
  };
  images.read = [look, cameras = std::array{images.left, images.right},
                 rays = std::array{rays_of(images.left), rays_of(images.right)},
                 depth_camera = *images.depth_camera](int k) {
    Frame frame;
    frame.stamp = k / 8.0;
    Eigen::Isometry3d T_WB(Eigen::AngleAxisd(0.03 * k, Eigen::Vector3d::UnitZ()));
    T_WB.translation() = Eigen::Vector3d(0.05 * k, 0.0, 0.0);
    for (const std::size_t right : {0, 1}) {
      const prospect::CalibratedCamera& camera = cameras[right];
      prospect::Image image(static_cast<int>(camera.pinhole.width),
                            static_cast<int>(camera.pinhole.height));
      for (std::size_t pixel = 0; pixel < image.pixels.size(); ++pixel) {
        const Surface seen = look(T_WB * camera.T_BC, rays[right][pixel]);
        image.pixels[pixel] = static_cast<std::uint8_t>(std::clamp(seen.grey, 0.0, 255.0));
      }
      (right == 1 ? frame.right : frame.left) = std::move(image);
    }
    const prospect::PinholeCamera& lens = depth_camera.camera;
    frame.depth = prospect::DepthImage(static_cast<int>(lens.width), static_cast<int>(lens.height));
    for (int v = 0; v < frame.depth.height; ++v) {
      for (int u = 0; u < frame.depth.width; ++u) {
        const Surface seen = look(T_WB * depth_camera.mount.T_BC, prospect::pixel_ray(lens, u, v));
        frame.depth.at(u, v) = static_cast<float>(seen.depth);
      }
    }
    return frame;
  };
  return images;
}

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "tests/images/image_file.h"
#include "tests/perception/depth_scene.h"

namespace prospect::test {

/// A walk with a depth camera through a furnished room, and recordings of it as files.
struct DepthRecording {
  static constexpr double kNoise = 0.0015;  // [1/m], about a structured-light camera's
  PinholeCamera camera{262.5, 262.5, 159.5, 119.5, 320.0, 240.0};
  DepthScene scene;
  int frames = 12;
  double period = 0.1;  ///< [s]
  double step = 0.03;   ///< from frame to frame [m]
  /// The recording's world, whose axes point anywhere.
  Eigen::Isometry3d T_DW = Eigen::Isometry3d::Identity();

  DepthRecording() {
    scene.boxes = {{{1.3, -0.9, 0.0}, {1.7, -0.4, 0.9}}, {{2.2, 0.6, 0.0}, {2.9, 1.4, 0.55}}};
    T_DW.rotate(Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.6, -0.5, 0.3).normalized()));
    T_DW.translation() << 0.4, -3.0, 1.1;
  }

  Eigen::Isometry3d pose(int k) const {  // in W of the scene
    constexpr double kDegree = M_PI / 180.0;
    return DepthScene::looking(-1.4 + step * k, 0.05 * std::sin(0.3 * k), 0.62,
                               (2.0 * k - 8.0) * kDegree, 18.0 * kDegree, 2.0 * kDegree);
  }

  /// Writes image k; `unit` [m].
  void write_image(const std::string& path, int k, double unit) const {
    const DepthImage image =
        scene.render(camera, pose(k), kNoise, 100 + static_cast<std::uint64_t>(k));
    cv::Mat raw(image.height, image.width, CV_16UC1, cv::Scalar(0));
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const float z = image.at(u, v);
        if (std::isfinite(z)) {
          raw.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(z / unit));
        }
      }
    }
    test::write_image(path, raw);
  }

  static std::string frame_name(int n) {
    char name[32];
    std::snprintf(name, sizeof name, "frame-%06d", n);
    return name;
  }

  void write_intrinsics(const std::string& folder) const {
    std::ofstream(folder + "/camera-intrinsics.txt")
        << camera.fx << " 0 " << camera.cx << "\n0 " << camera.fy << " " << camera.cy
        << "\n0 0 1\n";
  }

  static std::string pose_text(const Eigen::Isometry3d& T) {
    std::ostringstream text;
    text.precision(12);
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) text << T.matrix()(r, c) << (c == 3 ? '\n' : ' ');
    }
    return text.str();
  }

  /// 7-Scenes: every third of 30 frames a second. From frame `jump` on the poses are off by `off`
  /// [m, in W].
  void write_seven_scenes(const std::string& folder, int jump = 1000,
                          const Eigen::Vector3d& off = Eigen::Vector3d::Zero()) const {
    std::filesystem::create_directories(folder);
    write_intrinsics(folder);
    for (int k = 0; k < frames; ++k) {
      const std::string name = folder + "/" + frame_name(3 * k);
      write_image(name + ".depth.png", k, 0.001);
      Eigen::Isometry3d T = pose(k);
      if (k >= jump) T.translation() += off;
      std::ofstream(name + ".pose.txt") << pose_text(T_DW * T);
    }
  }

  void write_tum(const std::string& folder) const {
    std::filesystem::create_directories(folder + "/depth");
    write_intrinsics(folder);
    std::ofstream list(folder + "/depth.txt"), truth(folder + "/groundtruth.txt");
    list << "# depth maps\n";
    truth << "# timestamp tx ty tz qx qy qz qw\n";
    for (int k = 0; k < frames; ++k) {
      char stamp[32];
      std::snprintf(stamp, sizeof stamp, "%.6f", 1305031102.0 + period * k);
      const std::string name = std::string("depth/") + stamp + ".png";
      write_image(folder + "/" + name, k, 1.0 / 5000);
      list << stamp << " " << name << "\n";
      const Eigen::Isometry3d T = T_DW * pose(k);
      const Eigen::Quaterniond q(T.linear());
      char line[256];
      std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                    1305031102.004 + period * k, T.translation().x(), T.translation().y(),
                    T.translation().z(), q.x(), q.y(), q.z(), q.w());
      truth << line;
    }
  }

  void write_numbered(const std::string& folder) const {
    std::filesystem::create_directories(folder + "/depth");
    for (int k = 0; k < frames; ++k) {
      char name[32];
      std::snprintf(name, sizeof name, "/depth/%03d.png", 22 + 3 * k);
      write_image(folder + name, k, 0.001);
    }
  }
};

}  // namespace prospect::test

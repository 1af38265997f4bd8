#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "models/camera.h"
#include "perception/odometry/image.h"

namespace prospect::test {

/// A room with a box-shaped pillar, all surfaces textured by smooth noise, seen by an ideal stereo
/// pair: images with exact poses, depths and disparities. World: z up, the floor at z = 0.
class RenderedRoom {
 public:
  /// `period` [m], a multiple of 0.04: the texture repeats itself after it in x, y and z, as tiles
  /// do; 0: never.
  explicit RenderedRoom(double contrast = 70.0, double period = 0.0)
      : contrast_(contrast), period_(period) {}

  /// Depth along the optical axis of the surface that pixel (u, v) shows [m].
  double depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, double u,
               double v) const {
    Eigen::Vector3d hit;
    return cast(camera, T_WC, u, v, hit);
  }

  /// Grey image; Gaussian noise of `noise` grey levels drawn from `seed`.
  Image render(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, double noise,
               std::uint64_t seed) const {
    Image image(static_cast<int>(camera.width), static_cast<int>(camera.height));
    std::mt19937 generator(static_cast<std::uint32_t>(seed * 2654435761u + 1));
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        Eigen::Vector3d hit;
        cast(camera, T_WC, u, v, hit);
        // Sum of four uniform numbers: near enough to Gaussian, and fast.
        const std::uint32_t a = generator();
        const double sum = (a & 255) + (a >> 8 & 255) + (a >> 16 & 255) + (a >> 24);
        const double grey = 128.0 + texture(hit) + noise * (sum - 510.0) / 147.8;
        image.at(u, v) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
      }
    }
    return image;
  }

  struct Pair {
    Image left, right;
  };
  Pair render(const StereoCamera& camera, const Eigen::Isometry3d& T_WC, double noise,
              std::uint64_t seed) const {
    Eigen::Isometry3d right = T_WC;
    right.translation() += T_WC.linear().col(0) * camera.baseline;
    return {render(camera.left, T_WC, noise, 2 * seed),
            render(camera.left, right, noise, 2 * seed + 1)};
  }

  /// A camera at (x, y, z) looking along `yaw` from the world's x axis, level.
  static Eigen::Isometry3d looking(double x, double y, double z, double yaw) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const double c = std::cos(yaw), s = std::sin(yaw);
    T.linear().col(0) << s, -c, 0.0;
    T.linear().col(1) << 0.0, 0.0, -1.0;
    T.linear().col(2) << c, s, 0.0;
    T.translation() << x, y, z;
    return T;
  }

 private:
  struct Box {
    Eigen::Vector3d low, high;
  };
  static constexpr double kFar = 1e9;

  double cast(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, double u, double v,
              Eigen::Vector3d& hit) const {
    const Eigen::Vector3d ray = T_WC.linear() * Eigen::Vector3d((u - camera.cx) / camera.fx,
                                                                (v - camera.cy) / camera.fy, 1.0);
    const Eigen::Vector3d origin = T_WC.translation();
    // Inside of the room: where the ray leaves it.
    double t = kFar;
    for (int i = 0; i < 3; ++i) {
      if (ray[i] > 0) t = std::min(t, (room_.high[i] - origin[i]) / ray[i]);
      if (ray[i] < 0) t = std::min(t, (room_.low[i] - origin[i]) / ray[i]);
    }
    // Outside of the pillar: where the ray enters it.
    double enter = 0.0, leave = kFar;
    for (int i = 0; i < 3; ++i) {
      const double a = (pillar_.low[i] - origin[i]) / ray[i];
      const double b = (pillar_.high[i] - origin[i]) / ray[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter > 0.0 && enter < leave) t = std::min(t, enter);
    hit = origin + t * ray;
    return t;  // the ray's component along the optical axis is 1
  }

  static double lattice(int x, int y, int z, int octave) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 73856093u ^
                      static_cast<std::uint32_t>(y) * 19349663u ^
                      static_cast<std::uint32_t>(z) * 83492791u ^
                      static_cast<std::uint32_t>(octave) * 2971215073u;
    h ^= h >> 15;
    h *= 2246822519u;
    h ^= h >> 13;
    h *= 3266489917u;
    h ^= h >> 16;
    return h / 4294967295.0 - 0.5;
  }

  /// Value noise of four octaves, in space.
  double texture(const Eigen::Vector3d& p) const {
    double sum = 0.0;
    double size = 0.32;
    for (int octave = 0; octave < 4; ++octave, size *= 0.5) {
      const int n = static_cast<int>(std::lround(period_ / size));  // points of the lattice
      if (period_ > 0.0 && n == 0) continue;
      const auto wrapped = [n](int i) { return n > 0 ? (i % n + n) % n : i; };
      const Eigen::Vector3d q = p / size;
      const Eigen::Vector3d f(std::floor(q.x()), std::floor(q.y()), std::floor(q.z()));
      Eigen::Vector3d w = q - f;
      for (double& x : w) x = x * x * (3.0 - 2.0 * x);
      const int x = static_cast<int>(f.x()), y = static_cast<int>(f.y()),
                z = static_cast<int>(f.z());
      double value = 0.0;
      for (int k = 0; k < 8; ++k) {
        value += (k & 1 ? w.x() : 1 - w.x()) * (k & 2 ? w.y() : 1 - w.y()) *
                 (k & 4 ? w.z() : 1 - w.z()) *
                 lattice(wrapped(x + (k & 1)), wrapped(y + (k >> 1 & 1)), wrapped(z + (k >> 2 & 1)),
                         octave);
      }
      sum += value;
    }
    return contrast_ * sum;
  }

  double contrast_, period_;
  // Not on the lattice of the texture.
  Box room_{{-3.03, -2.51, 0.013}, {5.07, 2.77, 2.61}};
  Box pillar_{{2.53, -0.71, 0.013}, {3.17, 0.11, 1.83}};
};

}  // namespace prospect::test

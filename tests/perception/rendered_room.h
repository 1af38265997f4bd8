// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "models/camera.h"
#include "models/image.h"

namespace prospect::test {

/// A room with a box-shaped pillar, all surfaces textured by smooth noise, seen by an ideal stereo
/// pair: images with exact poses, depths and disparities. World: z up, the floor at z = 0.
class RenderedRoom {
 public:
  /// `period` [m], a multiple of 0.04: the texture repeats itself after it in x, y and z, as tiles
  /// do; 0: never.
  explicit RenderedRoom(double contrast = 70.0, double period = 0.0)
      : contrast_(contrast), repeats_(period > 0.0) {
    for (int octave = 0; octave < kOctaves; ++octave) {
      points_[static_cast<std::size_t>(octave)] =
          static_cast<int>(std::lround(std::ldexp(period / kSize, octave)));
    }
  }

  /// The pillar stands so far from where it stood at first [m], with its texture.
  void move_pillar(const Eigen::Vector3d& by) { moved_ = by; }
  /// Distance of a point from the room's walls, floor and ceiling [m].
  double to_room(const Eigen::Vector3d& p) const {
    return std::min((p - room_.low).cwiseAbs().minCoeff(), (p - room_.high).cwiseAbs().minCoeff());
  }

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
    Cells cells;
    std::mt19937 generator(static_cast<std::uint32_t>(seed * 2654435761u + 1));
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        Eigen::Vector3d hit;
        cast(camera, T_WC, u, v, hit);
        // Sum of four uniform numbers: near enough to Gaussian, and fast.
        const std::uint32_t a = generator();
        const double sum = (a & 255) + (a >> 8 & 255) + (a >> 16 & 255) + (a >> 24);
        const double grey = 128.0 + texture(hit, cells) + noise * (sum - 510.0) / 147.8;
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
      const double a = (pillar_.low[i] + moved_[i] - origin[i]) / ray[i];
      const double b = (pillar_.high[i] + moved_[i] - origin[i]) / ray[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    const bool pillar = enter > 0.0 && enter < std::min(leave, t);
    if (pillar) t = enter;
    hit = origin + t * ray;
    if (pillar) hit -= moved_;
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

  static constexpr int kOctaves = 4;
  static constexpr double kSize = 0.32;  // [m], of the first octave's cells
  /// The cell of the lattice that was last looked at, of each octave: neighbouring pixels mostly
  /// show the same one, and making its corners is most of what an image costs.
  struct Cell {
    double x = std::numeric_limits<double>::infinity(), y = x, z = x;
    std::array<double, 8> corners{};
  };
  using Cells = std::array<Cell, kOctaves>;

  /// Value noise of four octaves, in space.
  double texture(const Eigen::Vector3d& p, Cells& cells) const {
    const auto smooth = [](double x) { return x * x * (3.0 - 2.0 * x); };
    double sum = 0.0;
    // Numbers one by one: this is most of what an image costs, and tests are compiled with -O1.
    double x = p.x() / kSize, y = p.y() / kSize, z = p.z() / kSize;
    for (int octave = 0; octave < kOctaves; ++octave, x *= 2.0, y *= 2.0, z *= 2.0) {
      const int n = points_[static_cast<std::size_t>(octave)];
      if (repeats_ && n == 0) continue;
      const double fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
      Cell& cell = cells[static_cast<std::size_t>(octave)];
      if (fx != cell.x || fy != cell.y || fz != cell.z) {
        cell.x = fx, cell.y = fy, cell.z = fz;
        const auto wrapped = [n](int i) { return n > 0 ? (i % n + n) % n : i; };
        const int i = static_cast<int>(fx), j = static_cast<int>(fy), l = static_cast<int>(fz);
        for (int k = 0; k < 8; ++k) {
          cell.corners[static_cast<std::size_t>(k)] = lattice(
              wrapped(i + (k & 1)), wrapped(j + (k >> 1 & 1)), wrapped(l + (k >> 2 & 1)), octave);
        }
      }
      const double wx = smooth(x - fx), wy = smooth(y - fy), wz = smooth(z - fz);
      const double vx = 1 - wx, vy = 1 - wy, vz = 1 - wz;
      const double* c = cell.corners.data();
      const double a00 = vx * vy, a10 = wx * vy, a01 = vx * wy, a11 = wx * wy;
      sum += a00 * vz * c[0] + a10 * vz * c[1] + a01 * vz * c[2] + a11 * vz * c[3] +
             a00 * wz * c[4] + a10 * wz * c[5] + a01 * wz * c[6] + a11 * wz * c[7];
    }
    return contrast_ * sum;
  }

  double contrast_;
  bool repeats_;
  std::array<int, kOctaves> points_{};  // of the lattice in a period
  // Not on the lattice of the texture.
  Box room_{{-3.03, -2.51, 0.013}, {5.07, 2.77, 2.61}};
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();
  Box pillar_{{2.53, -0.71, 0.013}, {3.17, 0.11, 1.83}};
};

}  // namespace prospect::test

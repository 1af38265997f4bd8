// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace prospect::test {

/// Points [m] on the surfaces of a room of 6 x 4 m: floor, walls of 2 m, a crate of 1 m, a ceiling.
struct RoomPoints {
  double spacing = 0.04;  ///< [m]
  double noise = 0.0;     ///< standard deviation along each axis [m]
  double floor = 0.0;     ///< its height [m]
  bool with_floor = true, with_ceiling = true;

  std::vector<Eigen::Vector3d> points() const {
    std::vector<Eigen::Vector3d> all;
    std::mt19937 generator(5);
    std::normal_distribution<double> error(0.0, noise > 0.0 ? noise : 1.0);
    const auto add = [&](double x, double y, double z) {
      Eigen::Vector3d p(x, y, z + floor);
      if (noise > 0.0) {
        for (int k = 0; k < 3; ++k) p[k] += error(generator);
      }
      all.push_back(p);
    };
    const auto box = [&](double x0, double y0, double x1, double y1, double height) {
      for (double z = 0.5 * spacing; z < height; z += spacing) {
        for (double x = x0; x <= x1; x += spacing) add(x, y0, z), add(x, y1, z);
        for (double y = y0; y <= y1; y += spacing) add(x0, y, z), add(x1, y, z);
      }
    };
    const double half = 0.5 * spacing;
    for (double x = half; x < 6.0; x += spacing) {
      for (double y = half; y < 4.0; y += spacing) {
        const bool crate = x > 4.0 && x < 5.0 && y > 1.0 && y < 2.0;
        if (crate) add(x, y, 1.0);
        if (with_floor && !crate) add(x, y, 0.0);
        if (with_ceiling) add(x, y, 2.0);
      }
    }
    box(0.0, 0.0, 6.0, 4.0, 2.0);
    box(4.0, 1.0, 5.0, 2.0, 1.0);
    return all;
  }
};

template <typename T>
std::string bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// A PCD with x, y, z as floats of 4 bytes. data: "ascii", "binary" or "binary_compressed".
inline std::string pcd(const std::vector<Eigen::Vector3d>& points, const std::string& data) {
  const std::string n = std::to_string(points.size());
  std::string file =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
      "WIDTH " +
      n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
  std::string body;
  if (data == "ascii") {
    for (const auto& p : points) {
      body +=
          std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z()) + '\n';
    }
    return file + body;
  }
  if (data == "binary") {
    for (const auto& p : points) {
      for (int k = 0; k < 3; ++k) body += bytes_of(static_cast<float>(p[k]));
    }
    return file + body;
  }
  for (int k = 0; k < 3; ++k) {
    for (const auto& p : points) body += bytes_of(static_cast<float>(p[k]));
  }
  // LZF of bytes as they are.
  std::string block;
  for (std::size_t at = 0; at < body.size(); at += 32) {
    const std::string run = body.substr(at, 32);
    block += static_cast<char>(run.size() - 1) + run;
  }
  return file + bytes_of(static_cast<std::uint32_t>(block.size())) +
         bytes_of(static_cast<std::uint32_t>(body.size())) + block;
}

}  // namespace prospect::test

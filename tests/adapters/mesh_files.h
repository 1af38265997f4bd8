// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace prospect::test {

/// A folder of its own that goes with the test.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("prospect " + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// An image of one row: 40 on the left, 200 on the right.
inline std::string two_greys_pgm() { return std::string("P5\n2 1\n255\n") + char(40) + char(200); }

/// A box [0, x] x [0, y] x [0, z] with its faces turned inwards, as Wavefront OBJ with y up: a
/// room.
inline std::string room_obj(double x, double y, double z) {
  std::string text = "mtllib room.mtl\n";
  for (int n = 0; n < 8; ++n) {
    char line[100];
    // (x, y, z) with z up is (x, z, -y) with y up.
    std::snprintf(line, sizeof line, "v %g %g %g\n", n & 1 ? x : 0.0, n & 4 ? z : 0.0,
                  n & 2 ? -y : 0.0);
    text += line;
  }
  text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl stripes\n";
  // Floor, ceiling, y = 0, y = y, x = 0, x = x; seen from inside counter-clockwise.
  text += "f 1/1 2/2 4/3 3/4\nf 5/1 7/2 8/3 6/4\nf 1/1 5/2 6/3 2/4\nf 3/1 4/2 8/3 7/4\n";
  text += "f 1/1 3/2 7/3 5/4\nf 2/1 6/2 8/3 4/4\n";
  return text;
}

inline std::string room_mtl() { return "newmtl stripes\nKd 0.5 0.5 0.5\nmap_Kd stripes.pgm\n"; }

}  // namespace prospect::test

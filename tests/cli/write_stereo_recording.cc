// SPDX-License-Identifier: Apache-2.0
// write_stereo_recording FOLDER FRAMES [BLANK [BASELINE]]: a recording in KITTI layout, with ground
// truth, of a camera that goes through the rendered room; frame BLANK (-1: none) shows nothing, and
// the calibration says BASELINE [m] instead of the true 0.12. For the tests of the command line and
// of the page.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "adapters/formats/datasets/trajectory.h"
#include "tests/images/image_file.h"
#include "tests/perception/rendered_room.h"

using prospect::Image;
using prospect::test::RenderedRoom;
using prospect::test::write_image;

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: write_stereo_recording FOLDER FRAMES [BLANK [BASELINE]]\n");
    return 2;
  }
  const std::string folder = argv[1];
  const int frames = std::atoi(argv[2]);
  const int blank = argc > 3 ? std::atoi(argv[3]) : -1;
  const double baseline = argc > 4 ? std::atof(argv[4]) : 0.12;
  prospect::StereoCamera camera;
  camera.left = {275.0, 275.0, 200.0, 150.0, 400.0, 300.0};
  camera.baseline = 0.12;
  std::filesystem::create_directories(folder + "/image_0");
  std::filesystem::create_directories(folder + "/image_1");
  std::ofstream(folder + "/calib.txt")
      << "P0: 275 0 200 0 0 275 150 0 0 0 1 0\n"
      << "P1: 275 0 200 " << -275.0 * baseline << " 0 275 150 0 0 0 1 0\n";
  std::ofstream times(folder + "/times.txt");
  prospect::Trajectory truth;
  for (int k = 0; k < frames; ++k) {
    const Eigen::Isometry3d T_WC =
        RenderedRoom::looking(-1.5 + 0.04 * k, -0.5 + 0.01 * k, 1.05, -0.2 + 0.015 * k);
    RenderedRoom::Pair pair = RenderedRoom().render(camera, T_WC, 2.0, k);
    if (k == blank) pair = {Image(400, 300, 100), Image(400, 300, 100)};
    char name[32];
    std::snprintf(name, sizeof name, "/%06d.png", k);
    write_image(folder + "/image_0" + name, pair.left);
    write_image(folder + "/image_1" + name, pair.right);
    times << 0.1 * k << '\n';
    truth.push_back({0.1 * k, T_WC});
  }
  std::ofstream(folder + "/poses.txt") << prospect::kitti_text(truth);
  return 0;
}

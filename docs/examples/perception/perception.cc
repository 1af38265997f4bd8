// SPDX-License-Identifier: Apache-2.0
// From two cameras to what the planner knows: pose, covariance, landmarks, map.
//   perception          images of a room, made here: two cameras with lenses, a depth camera
//   perception FOLDER   a recording of rectified pairs: calib.txt (P0, P1), times.txt, image_0/ and
//                       image_1/ with 000000.png and so on; without depth, so nothing is mapped

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>

#include "images.h"
#include "perception/odometry/rectification.h"
#include "perception/pipeline/perception_pipeline.h"

namespace {

void say(double stamp, const prospect::InputResult& result) {
  if (!result.reason.empty()) {
    std::printf("%5.2f s: %s: %s\n", stamp, to_string(result.state).data(), result.reason.c_str());
  }
}

void run(const Images& images) {
  const prospect::Rectification rectification(images.left, images.right);
  prospect::PerceptionOptions options;
  options.stereo_mount.T_BC = rectification.T_BC();
  options.depth_camera = images.depth_camera;
  options.wheels = false;  // with wheels: perception.wheels(...), and losses of sight are bridged
  prospect::PerceptionPipeline perception(rectification.camera(), options);

  std::shared_ptr<const prospect::Belief> belief;
  for (int k = 0; k < images.size; ++k) {
    const Frame now = images.read(k);
    const prospect::ImagePair pair = rectification.pair(now.left.view(), now.right.view());
    say(now.stamp, perception.stereo({now.stamp, now.stamp, pair.left.view(), pair.right.view()}));
    if (images.depth_camera) say(now.stamp, perception.depth(now.stamp, now.depth));

    belief = perception.belief();  // for Planner::plan(); never changes afterwards
    const double sigma = std::sqrt(belief->covariance.topLeftCorner<2, 2>().trace());
    std::printf("%5.2f s: x %.3f m, y %.3f m, yaw %.3f rad, +- %.4f m; %s, %d tracked\n", now.stamp,
                belief->pose.position.x(), belief->pose.position.y(), belief->pose.yaw, sigma,
                to_string(belief->localization).data(), belief->tracked_features);
  }
  const auto volume = [&](prospect::CellState state) {
    const auto& voxels = belief->voxels->data();
    return std::pow(belief->voxels->resolution(), 3) *
           static_cast<double>(std::count(voxels.begin(), voxels.end(), state));
  };
  std::printf("%zu landmarks; %.2f m3 free, %.2f m3 occupied; %s\n",
              belief->landmarks->landmarks.size(), volume(prospect::CellState::kFree),
              volume(prospect::CellState::kOccupied), to_string(perception.map_state()).data());
}

}  // namespace

int main(int argc, char** argv) try {
  run(argc > 1 ? recorded_images(argv[1]) : made_images());
} catch (const std::exception& problem) {
  std::fprintf(stderr, "perception: %s\n", problem.what());
  return 2;
}

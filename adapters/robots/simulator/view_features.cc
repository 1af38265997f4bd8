// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/view_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "adapters/formats/files/not_built_in.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/lattice_cell.h"
#include "perception/odometry/stereo_matcher.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect {
namespace {

/// One place in each square of `spacing` [m], in the order of squares.
std::vector<Eigen::Vector2d> places_to_look_from(const World& world, double spacing) {
  const Grid<std::uint8_t> standing = connected_component(
      standing_columns(world.voxels, {}),
      world.voxels.frame().cell(world.start.position.x(), world.start.position.y()));
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    Eigen::Vector2d place;
  };
  std::map<std::pair<int, int>, Nearest> squares;
  for (int n = 0; n < standing.frame.size(); ++n) {
    if (standing.data[static_cast<std::size_t>(n)] == 0) continue;
    const Eigen::Vector2d place = standing.frame.center(standing.frame.at(n));
    const Eigen::Vector2d square = (place / spacing).array().floor();
    const double distance = (place - spacing * (square.array() + 0.5).matrix()).norm();
    Nearest& nearest = squares[{static_cast<int>(square.x()), static_cast<int>(square.y())}];
    if (distance < nearest.distance) nearest = {distance, place};
  }
  std::vector<Eigen::Vector2d> places;
  for (const auto& [square, nearest] : squares) places.push_back(nearest.place);
  // The start may be tighter than that.
  if (places.empty()) places.emplace_back(world.start.position.head<2>());
  return places;
}

}  // namespace

std::vector<Feature> features_in_views(const World& world, const SimulatorOptions& options) {
  constexpr double kSpacing = 2.5, kMerged = 0.1;  // [m]
  constexpr double kFar = 100.0;                   // [m]
  struct Sighting {
    Feature feature;
    std::uint64_t picture;
  };
  std::vector<Sighting> sightings;
  if (!world.mesh) return {};
  CameraRigOptions cameras = options.camera.rig;
  cameras.stereo = options.features.stereo;
  cameras.stereo_mount = options.stereo_mount;
  cameras.seed = stream_seed(options.seed, NoiseStream::kTexture);
  const CameraRig rig(std::make_shared<const SceneRenderer>(*world.mesh), cameras);
  const StereoOdometryOptions odometry;
  const PinholeCamera& camera = cameras.stereo.left;
  const double r = world.voxels.resolution();
  const double width = 2.0 * std::atan(0.5 * camera.width / camera.fx);
  const int directions = static_cast<int>(std::ceil(2.0 * std::numbers::pi / width));
  std::uint64_t picture = 0;
  for (const Eigen::Vector2d& place : places_to_look_from(world, kSpacing)) {
    for (int n = 0; n < directions; ++n) {
      Pose pose = world.start;
      pose.position << place, options.base_height;
      pose.yaw = 2.0 * std::numbers::pi * n / directions;
      const ImagePair pair = rig.stereo(pose, {}, ++picture);
      const ImagePyramid left(pair.left.view(), odometry.pyramid_levels);
      const ImagePyramid right(pair.right.view(), odometry.pyramid_levels);
      const auto corners = detect_corners(pair.left.view(), {}, odometry.corners);
      const Eigen::Isometry3d T_WC = camera_pose(pose, cameras.stereo_mount);
      const Eigen::Vector3d eye = T_WC.translation();
      for (const StereoMatch& match : match_stereo(left, right, corners, odometry.matching)) {
        const Eigen::Vector2f& p = corners[static_cast<std::size_t>(match.index)];
        const Eigen::Vector3d direction =
            (T_WC.linear() *
             Eigen::Vector3d((p.x() - camera.cx) / camera.fx, (p.y() - camera.cy) / camera.fy, 1.0))
                .normalized();
        const VoxelGrid::Ray ray = world.voxels.cast(eye, eye + kFar * direction);
        if (!ray.blocked || ray.unknown_length > 0.0) continue;
        Feature feature;
        feature.position = eye + ray.length * direction;
        // The face is across the axis along which the point lies on the lattice.
        const Eigen::Vector3d lattice = (feature.position / r).array().round() * r;
        int axis = 0;
        (feature.position - lattice).cwiseAbs().minCoeff(&axis);
        feature.position[axis] = lattice[axis];
        feature.normal = Eigen::Vector3d::Zero();
        feature.normal[axis] = direction[axis] > 0.0 ? -1.0 : 1.0;
        sightings.push_back({feature, picture});
      }
    }
  }

  // Of each cube the first picture that has a corner in it, and whether others have.
  std::unordered_map<std::uint64_t, std::pair<std::uint64_t, bool>> pictures;
  for (const Sighting& s : sightings) {
    const auto [at, first] =
        pictures.try_emplace(lattice_cell(s.feature.position, kMerged), s.picture, false);
    if (!first && at->second.first != s.picture) at->second.second = true;
  }
  const auto is_confirmed = [&](const Sighting& s) {
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3i cell(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      const Eigen::Vector3d aside = cell.cast<double>();
      const auto at = pictures.find(lattice_cell(s.feature.position + kMerged * aside, kMerged));
      if (at == pictures.end()) continue;
      if (at->second.second || at->second.first != s.picture) return true;
    }
    return false;
  };
  std::vector<Feature> found;
  std::unordered_set<std::uint64_t> taken;
  for (const Sighting& s : sightings) {
    if (taken.count(lattice_cell(s.feature.position, kMerged)) > 0 || !is_confirmed(s)) continue;
    taken.insert(lattice_cell(s.feature.position, kMerged));
    found.push_back(s.feature);
  }
  return found;
}

FeatureField tracked_field(const World& world, const SimulatorOptions& options) {
  if (world.mesh) {
    try {
      return FeatureField(world, features_in_views(world, options));
    } catch (const NotBuiltIn&) {
      // Nobody can tell what the mesh looks like.
    }
  }
  return simulated_features(world, options.seed);
}

}  // namespace prospect

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adapters/gazebo/gazebo_options.h"
#include "adapters/worlds/textured_mesh.h"
#include "adapters/worlds/world.h"
#include "models/robot_description.h"

namespace prospect {

struct GazeboWorldOptions {
  GazeboOptions robot;       ///< names, and what the wheels are
  double image_rate = 15.0;  ///< [Hz] of stereo pairs
  double depth_rate = 10.0;  ///< [Hz]
  double wall_height = 1.0;  ///< [m] of what a robot runs into, at least the body's
  double ambient = 0.6;      ///< of the light, as in SceneRendererOptions
  Eigen::Vector3d light = {0.35, 0.2, 0.9};
};

/// A world of voxels with a robot in it, for Gazebo 11: the files NAME.sdf, NAME.obj, NAME.mtl and
/// NAME_0.png, NAME_1.png, ... by name and content. `mesh` is the world's (world_mesh()).
///
/// Surfaces: those of the mesh, seen from where it is free, their textures on a few pages. The
/// light of SceneRenderer is painted into them, and Gazebo adds none. What a robot runs into: boxes
/// over all columns that are not free up to wall_height.
///
/// Robot: a differential drive with DiffDrivePlugin at the world's start, whose link `base` is the
/// body frame B; a multicamera of the stereo pair, a depth camera, two wheels, two casters without
/// friction. It cannot be seen, so that its cameras do not see it.
///
/// Errors: std::invalid_argument on options out of range, a mesh that is not one of axis-parallel
/// rectangles with a texture each (as that of a mesh file), or a stereo pair whose pixels are not
/// square: Gazebo's are, with the principal point in the middle.
std::vector<std::pair<std::string, std::string>> gazebo_world_files(
    const World& world, const TexturedMesh& mesh, const RobotDescription& robot,
    const GazeboWorldOptions& options, const std::string& name);

/// The stereo pair as Gazebo renders it: the same focal length and size, the principal point at
/// ((width - 1) / 2, (height - 1) / 2).
StereoCamera gazebo_stereo(const StereoCamera& stereo);

}  // namespace prospect

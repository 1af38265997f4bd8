// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "models/robot_description.h"

namespace prospect {

struct GazeboWorldOptions {
  GazeboRobotOptions robot;
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
/// Robot: gazebo_robot_model(), at the world's start.
///
/// Errors: as of gazebo_robot_model(); std::invalid_argument on options out of range, or a mesh
/// that is not one of axis-parallel rectangles with a texture each (as that of a mesh file).
std::vector<std::pair<std::string, std::string>> gazebo_world_files(
    const World& world, const TexturedMesh& mesh, const RobotDescription& robot,
    const GazeboWorldOptions& options, const std::string& name);

}  // namespace prospect

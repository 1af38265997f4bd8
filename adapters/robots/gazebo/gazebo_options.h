// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_node.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

class Knobs;

/// Of a differential drive in a Gazebo world: its names there, and what its wheels are. The
/// defaults are those of the robot that write_gazebo_world() puts into a world.
struct GazeboOptions {
  GazeboAddress address;
  std::string world;                        ///< empty: the one that is published
  std::string model = "robot";              ///< with the plug-in DiffDrivePlugin
  std::string link = "base";                ///< of the model, which bears the sensors
  std::string stereo = "stereo";            ///< sensor multicamera: left, then right
  std::string depth = "depth";              ///< sensor depth, the others depth_1, ...; empty: none
  int depth_sensors = 1;                    ///< so many has the robot (depth_sensors())
  std::string imu;                          ///< sensor imu, at the link's origin; empty: none
  std::string left_wheel = "left_wheel";    ///< link
  std::string right_wheel = "right_wheel";  ///< link
  int depth_width = 320;                    ///< [px]; the height follows from the field of view
  double image_noise = 1.5;                 ///< [grey levels]: GazeboImageNoise
  double wheel_radius = 0.08;               ///< [m]
  double wheel_separation = 0.32;           ///< [m] between the wheels' middles
  /// The plug-in turns to the right for a positive yaw rate, as it came with version 11.
  bool turned_yaw = true;
  double dead_man = 0.3;  ///< [s] > 0 of silence after which the relay stops
  double period = 0.02;   ///< [s] > 0 in which the relay looks, and repeats a stop
  /// [s] > 0 of the machine without an answer after which a world that is stepped is lost.
  double silence = 60.0;
  DepthRange depth_range = {0.2, 10.0};  ///< [m] outside of which a depth image says nothing
  std::uint64_t seed = 1;  ///< of the noise; of the physics of a world that is stepped
};

/// The knobs (models/knobs.h): numbers and switches. Names are texts.
void describe(Knobs& knobs, GazeboOptions& options);

/// "/gazebo/WORLD/MODEL/..." of the options, with the world that the node knows if they name none.
/// Throws InputError if there is none.
std::string gazebo_world_name(const GazeboOptions& options, const GazeboNode& node);

/// Of its depth cameras, by their number.
std::vector<std::string> gazebo_depth_names(const GazeboOptions& options);

/// Throws InputError, a line for each option out of range.
void check(const GazeboOptions& options);

}  // namespace prospect

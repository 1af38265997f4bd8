// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/task/task.h"

namespace prospect {

/// What a configuration is read for.
enum class ConfigurationUse {
  kAny,             ///< no mission: to look at it
  kExplore,         ///< the simulator in lockstep
  kDriveSimulator,  ///< the simulator in real time
  kDriveGazebo,
  kDriveDds,
  kExport,     ///< a world and the robot for Gazebo
  kRelay,      ///< the dead-man of a base behind topics
  kDriveUser,  ///< a program's own robot
  kOdometry,   ///< of a recording
  kMapDepth,   ///< a recording of depth images
  kMapStereo,  ///< a recording of a stereo pair
  kMapScans    ///< a recording of a lidar
};

/// Whether a robot of the simulator is driven.
constexpr bool is_simulated(ConfigurationUse use) {
  return use == ConfigurationUse::kExplore || use == ConfigurationUse::kDriveSimulator;
}

/// On what it depends who reads a key. What is not known yet is taken as what reads more.
struct KeyReader {
  ConfigurationUse use = ConfigurationUse::kAny;
  Sensors sensors = Sensors::kModel;  ///< of the simulator
  bool wheels = true;                 ///< perception.wheels
  TaskKind task = TaskKind::kExplore;
  std::optional<bool> textured{};  ///< the world is a mesh with textures
  bool world = true;               ///< a world is read
  // Of a robot that is neither simulated nor in Gazebo.
  std::optional<bool> depth{};                ///< it has depth images
  bool scans = true;                          ///< ... a lidar
  bool pairs = true;                          ///< ... a stereo camera
  bool poses = true;                          ///< ... a pose that something else tells
  bool by_wheels = false;                     ///< wheels alone localize it
  bool view_told = false;                     ///< its topics tell what its range sensor has in view
  std::vector<std::string> told_elsewhere{};  ///< keys that the topics' file stands above
};

/// "" if what a configuration is used for reads the key, else who does, and what is expected: "of a
/// robot in real time; expected it with prospect drive".
std::string unread_because(const std::string& key, const KeyReader& reader);

/// Throws InputError with each key that was told and that nothing reads: of settings, and of a file
/// where it is not the default. In a file, what is by name of another command or robot (drive,
/// gazebo, simulator, world; of export and relay all) is left: one file may describe a robot for
/// all its missions.
void refuse_unread(const std::vector<ConfigEntry>& entries, const KeyReader& reader);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/key_readers.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

using Use = ConfigurationUse;

bool real_time(const KeyReader& r) {
  return r.use == Use::kDriveSimulator || r.use == Use::kDriveGazebo || r.use == Use::kDriveDds ||
         r.use == Use::kDriveUser;
}
bool mission(const KeyReader& r) { return is_simulated(r.use) || real_time(r); }
bool own_sensors(const KeyReader& r) { return real_time(r) && r.use != Use::kDriveSimulator; }
bool rendered(const KeyReader& r) { return is_simulated(r.use) && r.sensors == Sensors::kCamera; }
bool modelled(const KeyReader& r) { return is_simulated(r.use) && r.sensors == Sensors::kModel; }
bool perceives(const KeyReader& r) { return own_sensors(r) || rendered(r); }
bool cameras(const KeyReader& r) { return perceives(r) && (rendered(r) || r.pairs); }
bool topics(const KeyReader& r) { return r.use == Use::kDriveDds; }
/// Each of its sensors has a clock of its own, and what they are nobody but itself knows.
bool real(const KeyReader& r) { return r.use == Use::kDriveDds || r.use == Use::kDriveUser; }
bool told_pose(const KeyReader& r) { return real(r) && r.poses; }
bool map_of_images(const KeyReader& r) {
  return r.use == Use::kMapDepth || r.use == Use::kMapStereo;
}
bool map(const KeyReader& r) { return map_of_images(r) || r.use == Use::kMapScans; }
bool own_accuracy(const KeyReader& r) { return r.use != Use::kMapStereo; }
bool measured(const KeyReader& r) { return r.world && !real(r); }
bool own_stereo(const KeyReader& r) { return !topics(r); }
bool own_principal_point(const KeyReader& r) { return !own_sensors(r) || r.use == Use::kDriveUser; }
bool own_view(const KeyReader& r) { return !(topics(r) && r.view_told); }

/// The keys at and below a path, who reads them, and what is said where nobody does. All rows of a
/// key must hold.
struct KeyRow {
  std::string_view path;
  bool (*read)(const KeyReader&);
  std::string_view refusal;
  /// In a file it is told by its name that it is of another command or robot.
  bool by_name = false;
};

constexpr std::string_view kStamps =
    "Gazebo's clock stamps all its sensors; expected it with --base dds";
constexpr std::string_view kModel =
    "of sensors that are a model; expected simulator.sensors: model";
constexpr std::string_view kRendered = "of rendered images; expected simulator.sensors: camera";
constexpr std::string_view kCameras =
    "of a robot with cameras; expected simulator.sensors: camera, or --base gazebo|dds";
constexpr std::string_view kPose =
    "of a pose from outside; expected it of a robot behind topics with pose.from, or of one's own";
constexpr std::string_view kPair =
    "the recording's stereo pair tells it; expected it of depth images or scans";

constexpr std::string_view kTopics = "the robot's topics tell it; expected it with another robot";

constexpr std::array kRows = {
    KeyRow{"robot.stereo.fx", own_stereo, kTopics, true},
    KeyRow{"robot.stereo.fy", own_stereo, kTopics, true},
    KeyRow{"robot.stereo.width", own_stereo, kTopics, true},
    KeyRow{"robot.stereo.height", own_stereo, kTopics, true},
    KeyRow{"robot.stereo.baseline", own_stereo, kTopics, true},
    KeyRow{"robot.stereo.cx", own_principal_point,
           "the cameras tell it, in Gazebo the middle; expected it with another robot", true},
    KeyRow{"robot.stereo.cy", own_principal_point,
           "the cameras tell it, in Gazebo the middle; expected it with another robot", true},
    KeyRow{"robot.depth.horizontal_fov", own_view, kTopics, true},
    KeyRow{"robot.depth.vertical_fov", own_view, kTopics, true},
    KeyRow{"drive", real_time, "of a mission in real time; expected it with prospect drive", true},
    KeyRow{"drive.simulator", [](const KeyReader& r) { return r.use == Use::kDriveSimulator; },
           "of the simulator's base; expected it with --base simulator", true},
    KeyRow{"drive.inbox", own_sensors,
           "of a robot with sensors of its own; expected it with --base gazebo|dds", true},
    KeyRow{"drive.inbox.cameras_in_runtime_clock", real, kStamps, true},
    KeyRow{"drive.inbox.wheels_in_runtime_clock", real, kStamps, true},
    KeyRow{"drive.inbox.depth_in_runtime_clock", real, kStamps, true},
    KeyRow{"drive.inbox.scan_in_runtime_clock", real, kStamps, true},
    KeyRow{"drive.inbox.poses_in_runtime_clock", told_pose, kPose, true},
    KeyRow{"drive.inbox.one_clock", real, kStamps, true},
    KeyRow{"drive.inbox.pose_jump", told_pose, kPose, true},
    KeyRow{"perception.pose_degraded", told_pose, kPose},
    KeyRow{"perception.pose_lost", told_pose, kPose},
    KeyRow{"gazebo", [](const KeyReader& r) { return r.use == Use::kDriveGazebo; },
           "of a robot in Gazebo; expected it with prospect drive --base gazebo", true},
    KeyRow{"base", [](const KeyReader& r) { return r.use == Use::kDriveUser; },
           "of a robot's own driver; expected it with prospect drive --base plugin:FILE", true},
    KeyRow{"world", measured, "no world is read; expected it with a simulated world", true},
    KeyRow{"world.start", [](const KeyReader& r) { return r.use != Use::kDriveGazebo; },
           "the robot begins where it stands; expected it with a simulated world", true},
    KeyRow{"mission.until", measured,
           "nobody measures what was seen; expected --measure beside --base gazebo"},
    KeyRow{"simulator", [](const KeyReader& r) { return is_simulated(r.use); },
           "of the simulator; expected it with prospect explore, or --base simulator", true},
    KeyRow{"task.area", [](const KeyReader& r) { return r.task == TaskKind::kExplore; },
           "of an exploration; expected task.kind: explore"},
    KeyRow{"task.goal", [](const KeyReader& r) { return r.task == TaskKind::kGoTo; },
           "of a goal to go to; expected task.kind: go"},
    KeyRow{"simulator.odometry", modelled, kModel},
    KeyRow{"simulator.features", modelled, kModel},
    KeyRow{"simulator.landmarks", modelled, kModel},
    // Of a mesh, the features that sensors as a model track are looked for in images of it.
    KeyRow{"simulator.camera",
           [](const KeyReader& r) { return rendered(r) || r.textured.value_or(true); }, kRendered},
    KeyRow{"simulator.camera.texture_quality", rendered, kRendered},
    KeyRow{"simulator.camera.focal_error", rendered, kRendered},
    KeyRow{"simulator.camera.baseline_error", rendered, kRendered},
    KeyRow{"simulator.camera.realism", rendered, kRendered},
    KeyRow{"simulator.camera.effects", rendered, kRendered},
    KeyRow{"simulator.camera.depth_width", rendered, kRendered},
    KeyRow{"simulator.camera.depth_height", rendered, kRendered},
    KeyRow{"simulator.camera.max_incidence", rendered, kRendered},
    KeyRow{"simulator.wheels", [](const KeyReader& r) { return rendered(r) && r.wheels; },
           "of wheels beside cameras; expected simulator.sensors: camera and perception.wheels: "
           "true"},
    KeyRow{"perception.wheels", cameras, kCameras},
    KeyRow{"perception.wheel_fusion",
           [](const KeyReader& r) { return (cameras(r) && r.wheels) || r.by_wheels; },
           "of wheels beside cameras; expected cameras and perception.wheels: true"},
    KeyRow{"perception.inertial",
           [](const KeyReader& r) { return cameras(r) || r.use == Use::kOdometry; }, kCameras},
    KeyRow{"perception.odometry",
           [](const KeyReader& r) { return cameras(r) || r.use == Use::kOdometry; }, kCameras},
    KeyRow{"perception.mapping", [](const KeyReader& r) { return mission(r) || map(r); },
           "no map is made; expected it with prospect map"},
    KeyRow{"perception.mapping.offset_quadratic", own_accuracy, kPair},
    KeyRow{"perception.mapping.slopes", [](const KeyReader& r) { return modelled(r) || map(r); },
           "of poses that follow ramps; expected simulator.sensors: model, or prospect map"},
    KeyRow{"perception.depth_mapping",
           [](const KeyReader& r) {
             return (perceives(r) && r.depth.value_or(true)) || map_of_images(r);
           },
           "of depth images; expected a robot or a recording with them"},
    KeyRow{"perception.depth_mapping.ground.noise_quadratic", own_accuracy, kPair},
    KeyRow{"perception.depth_mapping.max_speed", own_accuracy, kPair},
    KeyRow{"perception.scan_mapping",
           [](const KeyReader& r) { return (real(r) && r.scans) || r.use == Use::kMapScans; },
           "of a lidar; expected a robot behind topics or a recording with one"},
    KeyRow{"perception.movers", [](const KeyReader& r) { return mission(r) || map(r); },
           "no map is made; expected it with prospect map"},
    KeyRow{"perception.feature_density", mission, "of missions; expected it in one"},
    KeyRow{"perception.loops", mission, "of missions; expected it in one"},
    KeyRow{"perception.start_floor", mission, "of missions; expected it in one"},
    KeyRow{"perception.same_time", cameras, kCameras},
    KeyRow{"perception.max_age", perceives, kCameras},
    KeyRow{"perception.max_leap", perceives, kCameras},
    KeyRow{"perception.max_ahead", perceives, kCameras},
    KeyRow{"perception.most_waiting", perceives, kCameras},
};

bool at_or_below(std::string_view key, std::string_view path) {
  return key.starts_with(path) &&
         (key.size() == path.size() || key[path.size()] == '.' || key[path.size()] == '[');
}

/// What commands read that read few keys.
constexpr std::string_view kReadByRelay[] = {
    "robot.model",         "robot.motion.v_min",    "robot.motion.v_max",  "robot.motion.vx_min",
    "robot.motion.vx_max", "robot.motion.vy_max",   "robot.motion.vz_max", "robot.motion.omega_max",
    "robot.motion.a_max",  "robot.motion.alpha_max"};
constexpr std::string_view kReadByExport[] = {"robot.motion.fixed_z",
                                              "robot.shape",
                                              "robot.stereo.fx",
                                              "robot.stereo.fy",
                                              "robot.stereo.width",
                                              "robot.stereo.height",
                                              "robot.stereo.baseline",
                                              "robot.stereo.mount",
                                              "robot.depth.horizontal_fov",
                                              "robot.depth.vertical_fov",
                                              "robot.depth.mount",
                                              "robot.more_depth",
                                              "perception.mapping.resolution",
                                              "world",
                                              "gazebo.model",
                                              "gazebo.link",
                                              "gazebo.stereo",
                                              "gazebo.depth",
                                              "gazebo.imu",
                                              "gazebo.left_wheel",
                                              "gazebo.right_wheel",
                                              "gazebo.depth_width",
                                              "gazebo.wheel_radius",
                                              "gazebo.wheel_separation"};
/// What else export reads: how rich the textures are that a world of voxels gets; the places that
/// ground without end reaches to.
bool exported(std::string_view key, const KeyReader& r) {
  if (key == "simulator.camera.texture_quality") return !r.textured.value_or(false);
  if (key == "task.area") return r.task == TaskKind::kExplore;
  return (key == "task.kind" || key == "task.goal") && r.task == TaskKind::kGoTo;
}

constexpr KeyRow kNotOfRelay{
    "", nullptr, "the relay reads how the robot may move; expected a key of robot.motion", true};
constexpr KeyRow kNotOfExport{
    "", nullptr, "nothing of the exported world or robot follows from it; expected a key that does",
    true};
constexpr KeyRow kToldElsewhere{
    "", nullptr, "the topics' file tells it below command; expected it in one place", true};

const KeyRow* refusing_row(std::string_view key, const KeyReader& reader) {
  if (reader.use == Use::kAny) return nullptr;
  const auto among = [&](const auto& paths) {
    return std::ranges::any_of(paths, [&](const auto& path) { return at_or_below(key, path); });
  };
  if (among(reader.told_elsewhere)) return &kToldElsewhere;
  if (reader.use == Use::kRelay) return among(kReadByRelay) ? nullptr : &kNotOfRelay;
  if (reader.use == Use::kExport) {
    return among(kReadByExport) || exported(key, reader) ? nullptr : &kNotOfExport;
  }
  for (const KeyRow& row : kRows) {
    if (at_or_below(key, row.path) && !row.read(reader)) return &row;
  }
  return nullptr;
}

}  // namespace

std::string unread_because(const std::string& key, const KeyReader& reader) {
  const KeyRow* row = refusing_row(key, reader);
  return row ? std::string(row->refusal) : "";
}

void refuse_unread(const std::vector<ConfigEntry>& entries, const KeyReader& reader) {
  std::vector<std::string> lines;
  for (const ConfigEntry& entry : entries) {
    if (!entry.from_file || (!entry.set && entry.value == entry.default_value)) continue;
    const KeyRow* row = refusing_row(entry.path, reader);
    if (row == nullptr || (row->by_name && !entry.set)) continue;
    lines.push_back(entry.where + ": " + entry.path +
                    ": nothing reads it here: " + std::string(row->refusal));
  }
  if (!lines.empty()) throw InputError(lines);
}

}  // namespace prospect

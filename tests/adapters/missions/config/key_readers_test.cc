// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/key_readers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/recordings/stereo_depth_source.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/live_perception.h"
#include "adapters/robots/dds/robot_with_cameras.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "adapters/robots/simulator/simulator.h"
#include "models/knobs.h"
#include "models/make_model.h"
#include "models/range_text.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "tests/adapters/box_room.h"

// No key is without effect: whatever a configuration is used for, each key reaches what is built of
// it, or is refused.
namespace prospect::key_readers_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Use = ConfigurationUse;

/// What is described, as text.
class Text final : public Knobs {
 public:
  void number(const char*, double& value, Range, const char*, const char*) override { add(value); }
  void degrees(const char*, double& value, Range, const char*) override { add(value); }
  void integer(const char*, int& value, WholeRange, const char*, const char*) override {
    add(value);
  }
  void boolean(const char*, bool& value, const char*) override { add(value); }
  void numbers(const char*, double* values, std::size_t count, Range, const char*,
               const char*) override {
    for (std::size_t i = 0; i < count; ++i) add(values[i]);
  }
  void require(bool, const char*, const char*) override {}

  template <typename Value>
  void add(const Value& value) {
    text << value << ' ';
  }
  template <typename Options>
  void add_all(Options options) {
    describe(*this, options);
  }
  void add_mount(const CameraMount& mount) { add(mount.T_BC.matrix()); }

  std::ostringstream text;

 private:
  void word(const char*, std::size_t& index, const std::vector<std::string>&,
            const char*) override {
    add(index);
  }
  void enter(const char*) override {}
  void leave() override {}
};

void add_shape(Text& text, const RobotShape& any) {
  text.add(any.index());
  std::visit(
      [&](const auto& shape) {
        if constexpr (requires(Text & t, std::decay_t<decltype(shape)> s) { describe(t, s); }) {
          text.add_all(shape);
        } else if constexpr (requires { shape.spheres; }) {
          for (const Sphere& sphere : shape.spheres) text.add_all(sphere);
        } else {
          for (const Eigen::Vector3d& vertex : shape.vertices) text.add(vertex.transpose());
        }
      },
      any);
}

/// The robot, its planner and its task, which all missions have.
void add_mission(Text& text, const Configuration& c) {
  ModelParameters motion = parameters_of(*c.robot.model);
  describe(text, c.robot.model->name(), motion);
  text.add(c.robot.model->name());
  add_shape(text, c.robot.shape);
  text.add_all(c.robot.stereo), text.add_mount(c.robot.stereo_mount);
  text.add_all(c.robot.depth), text.add_mount(c.robot.depth_mount);
  text.add(c.solver);
  text.add_all(c.planner);
  FrontierPlannerOptions end = c.planner.frontier_planner;
  describe_end(text, end);
  text.add_all(c.mission);
  text.add(c.until_coverage), text.add(c.until_area);
  const Task& task = c.planner.task;
  text.add(static_cast<int>(task.kind)), text.add(task.area ? task.area->size() : 0);
  if (task.kind == TaskKind::kGoTo) {
    text.add(task.goal.position.transpose()), text.add(task.goal.yaw.value_or(NAN));
  }
  text.add(task.goal.position_tolerance), text.add(task.goal.yaw_tolerance);
  const Zones& zones = c.planner.zones;
  text.add(zones.bound ? zones.bound->size() : 0);
  for (const Polygon& area : zones.keep_out) text.add(area.front().x());
  for (const SpeedZone& zone : zones.slow)
    text.add(zone.area.front().x()), text.add(zone.max_speed);
}

void add_world(Text& text, const Configuration& c) {
  const WorldOptions world = world_options_for(c);
  text.add(world.floor.value_or(NAN)), text.add(world.voxel_size), text.add(world.unknown_is_free);
  text.add(world.ground_margin), text.add(static_cast<int>(world.up.value_or(UpAxis::kZ))),
      text.add(world.start ? world.start->position.x() : NAN);
}

void add_drive(Text& text, const Configuration& c) {
  text.add_all(c.drive.driver), text.add_all(c.drive.preflight), text.add_all(c.drive.ranges);
}

/// What a simulated robot is made of.
void add_simulator(Text& text, const Configuration& c) {
  const SimulatorOptions& o = c.simulator;
  text.add_all(guard_limits_for(c));
  add_world(text, c);
  text.add(c.perception.loops);
  text.add(static_cast<int>(o.sensors)), text.add(o.depth_rate), text.add(o.image_rate);
  text.add(o.walkers.count), text.add(o.walkers.keep);
  text.add_all(o.actuation), text.add_all(o.depth), text.add_all(o.imu);
  for (const ScheduledCorrection& k : o.corrections) {
    text.add(k.time), text.add(k.x), text.add(k.y), text.add(k.yaw);
    text.add(static_cast<int>(k.kind));
  }
  for (const SimulatorOptions::Carried& k : o.carried) {
    text.add(k.time), text.add(k.to.position.x()), text.add(k.to.position.y()), text.add(k.to.yaw);
  }
  PerceptionOptions perception = c.perception;
  perception.mapping = mapping_options(o, perception.mapping);
  if (o.sensors == Sensors::kCamera) perception.mapping = mapping_of(perception);
  text.add_all(perception.mapping);
  text.add_all(c.perception.feature_density);
  text.add(c.perception.start_floor), text.add_all(c.perception.movers);
  text.add(c.map), text.add(o.place_known);
  if (o.sensors == Sensors::kModel) {
    text.add_all(o.odometry), text.add_all(o.features), text.add_all(o.landmarks);
    // What looks for features in the images of a mesh.
    const CameraRigOptions& rig = o.camera.rig;
    for (const double v : {rig.exposure, rig.exposure_time, rig.vignetting, rig.blur,
                           rig.read_noise, rig.shot_noise, double(rig.threads)}) {
      text.add(v);
    }
    return;
  }
  perception.scan_mapping = {};
  perception.pose_degraded = perception.pose_lost = 0.0;
  if (perception.wheels) {
    text.add_all(o.wheels);
  } else {
    perception.wheel_fusion = {};
  }
  text.add_all(o.camera), text.add_all(perception);
}

/// What is exported: the robot, its world, how rich the surfaces are that a world of voxels gets.
void add_export(Text& text, const Configuration& c) {
  GazeboRobotOptions options;
  options.names = c.gazebo;
  try {
    text.add(gazebo_robot_model(c.robot, options, Pose()));
  } catch (const std::invalid_argument& e) {
    text.add(e.what());
  }
  add_world(text, c);
  const WorldOptions world = world_options_for(c);
  text.add(world.slice.z_max), text.add(world.slice.standing_clearance);
  text.add(world.places.size());
  for (const Eigen::Vector2d& place : world.places) text.add(place.transpose());
  text.add(c.simulator.camera.texture_quality);
}

/// The limits that a relay completes.
void add_relay(Text& text, const Configuration& c) {
  text.add(c.robot.model->max_speed()), text.add(c.robot.model->max_yaw_rate());
  for (const ConfigEntry& entry : c.entries) {
    if (entry.path == "robot.motion.a_max" || entry.path == "robot.motion.alpha_max") {
      text.add(entry.value);
    }
  }
}

/// As a robot behind topics or in Gazebo tells its cameras.
RobotDescription as_told(const RobotDescription& robot, Use use) {
  if (use == Use::kDriveGazebo) return gazebo_robot(robot);
  DdsCameras cameras;
  cameras.stereo.emplace();
  cameras.depth.emplace();
  return robot_with(cameras, robot);
}

/// What is made of a configuration.
std::string built(Configuration c, Use use) {
  Text text;
  text.text.precision(17);
  if (use == Use::kRelay || use == Use::kExport) {
    use == Use::kRelay ? add_relay(text, c) : add_export(text, c);
    return text.text.str();
  }
  if (!is_simulated(use)) c.robot = as_told(c.robot, use);
  if (use == Use::kDriveGazebo) c.world.start.reset();  // where it stands
  if (use == Use::kDriveDds) c.until_coverage = c.until_area = 0.0;
  add_mission(text, c);
  if (is_simulated(use)) {
    add_simulator(text, c);
    if (use == Use::kDriveSimulator) add_drive(text, c), text.add_all(c.simulated_base);
    return text.text.str();
  }
  add_drive(text, c);
  text.add_all(c.guard);
  SensorInboxOptions inbox = c.drive.inbox;
  PerceptionOptions perception = live_perception(c, {}, Pose());
  perception.mapping = mapping_of(perception);
  if (use != Use::kDriveUser) {
    inbox.poses_in_runtime_clock = true;
    inbox.pose_jump = {};
    perception.pose_degraded = perception.pose_lost = 0.0;
  }
  if (use == Use::kDriveGazebo) {
    inbox.cameras_in_runtime_clock = inbox.wheels_in_runtime_clock = true;
    inbox.depth_in_runtime_clock = inbox.scan_in_runtime_clock = true;
    inbox.one_clock = false;
    perception.scan_mapping = {};
    text.add_all(c.gazebo);
    const GazeboOptions& g = c.gazebo;
    for (const std::string& name : {g.address.host, g.world, g.model, g.link, g.stereo, g.depth,
                                    g.imu, g.left_wheel, g.right_wheel}) {
      text.add(name);
    }
    add_world(text, c);
  }
  text.add_all(inbox), text.add_all(perception);
  return text.text.str();
}

/// Values of a key beside its default, some of which it may have.
std::vector<std::string> other_values(const ConfigEntry& e) {
  static const std::map<std::string, std::vector<std::string>> told = {
      {"planner.solver", {"nlopt:LN_BOBYQA"}},
      {"robot.model", {"multirotor"}},
      {"robot.motion.v_min", {"-3"}},
      {"simulator.corrections", {"[5, 1, 0, 10]"}},
      {"simulator.robot_corrections", {"[5, 1, 0, 10]"}},
      {"simulator.carried", {"[5, 1, 0, 10]"}},
      {"robot.motion.vx_min", {"-3"}},
      {"world.floor", {"1.5"}},
      {"world.start", {"[1, 2, 3]"}},
      {"task.area", {"[0, 0, 2, 0, 2, 2]"}},
      {"task.goal", {"[1, 2, 3]"}},
      {"zones.bound", {"[-9, -9, 9, -9, 9, 9, -9, 9]"}},
  };
  if (const auto own = told.find(e.path); own != told.end()) return own->second;
  if (e.range == "text") return {"another"};
  std::vector<std::string> values;
  const auto about = [&](double v) {
    for (const double other : {v * 1.01, v * 0.99, v + 1.0, v - 1.0, v + 0.01, v - 0.01}) {
      if (std::isfinite(other) && other != v) values.push_back(exact_text(other));
    }
    if (!std::isfinite(v)) values.push_back("1");
  };
  double number = 0.0;
  if (e.default_value == "inf" || parse_number(e.default_value, number)) {
    about(e.default_value == "inf" ? INFINITY : number);
  } else if (e.default_value.starts_with("[")) {
    const std::size_t comma = e.default_value.find_first_of(",]");
    parse_number(e.default_value.substr(1, comma - 1), number);
    about(number);
    for (std::string& value : values) value = "[" + value + e.default_value.substr(comma);
  } else {
    std::istringstream words(e.range);
    for (std::string word; std::getline(words >> std::ws, word, ',');) {
      if (word != e.default_value) values.push_back(word);
    }
  }
  return values;
}

/// What `read` makes of settings with another value of the key.
template <typename Read>
auto with_another(const ConfigEntry& e, std::vector<YamlSetting> settings, const Read& read)
    -> decltype(read(settings)) {
  std::string last;
  for (const std::string& value : other_values(e)) {
    std::vector<YamlSetting> all = settings;
    all.emplace_back(e.path + "=" + value);
    try {
      return read(all);
    } catch (const InputError& error) {
      last = error.what();
    }
  }
  ADD_FAILURE() << e.path << ": no other value is taken: " << last;
  return {};
}

auto reading(Use use) {
  return [use](const std::vector<YamlSetting>& settings) {
    return read_configuration("", {}, settings, use);
  };
}

struct Kind {
  const char* name;
  Use use;
  std::vector<YamlSetting> settings;
  std::vector<std::string> keys;  ///< "": all; else those that begin so: the rest is as before
};

TEST(KeyReaders, EachKeyReachesWhatIsBuiltOrIsRefused) {
  // Their keys are those of a back end and of terms.
  const std::set<std::string> left = {"planner.options", "planner.terms"};
  const std::vector<std::string> robots = {"robot.",      "drive.",     "gazebo.", "guard.",
                                           "perception.", "simulator.", "world.",  "mission."};
  for (const Kind& kind : {
           Kind{"explore", Use::kExplore, {}, {""}},
           Kind{"explore by cameras",
                Use::kExplore,
                {"simulator.sensors=camera"},
                {"simulator.", "perception."}},
           Kind{"explore by cameras without wheels",
                Use::kExplore,
                {"simulator.sensors=camera", "perception.wheels=false"},
                {"simulator.wheels.", "perception.wheel_fusion."}},
           Kind{"explore an area", Use::kExplore, {"task.area=[0, 0, 5, 0, 5, 5]"}, {"task."}},
           Kind{"go", Use::kExplore, {"task.kind=go", "task.goal=[5, 5]"}, {"task."}},
           Kind{"holonomic", Use::kExplore, {"robot.model=holonomic"}, {"robot."}},
           Kind{"accelerations", Use::kExplore, {"robot.model=unicycle_accel"}, {"robot."}},
           Kind{"multirotor", Use::kExplore, {"robot.model=multirotor"}, {"robot."}},
           Kind{"box", Use::kExplore, {"robot.shape.type=box"}, {"robot."}},
           Kind{"drive", Use::kDriveSimulator, {}, {"drive."}},
           Kind{"gazebo", Use::kDriveGazebo, {}, robots},
           Kind{"dds", Use::kDriveDds, {}, robots},
           Kind{"export", Use::kExport, {}, {""}},
           Kind{"export of a box", Use::kExport, {"robot.shape.type=box"}, {"robot."}},
           Kind{"export of a goal", Use::kExport, {"task.kind=go", "task.goal=[5, 5]"}, {"task."}},
           Kind{"relay", Use::kRelay, {}, {""}},
           Kind{"relay of a holonomic base", Use::kRelay, {"robot.model=holonomic"}, {"robot."}},
           Kind{"a program's own robot", Use::kDriveUser, {}, {"drive.inbox."}},
       }) {
    SCOPED_TRACE(kind.name);
    const Configuration before = read_configuration("", {}, kind.settings, kind.use);
    const std::string built_before = built(before, kind.use);
    KeyReader reader = key_reader(before, kind.use);
    if (kind.use == Use::kDriveDds) {  // as_told()
      reader.depth = reader.view_told = true;
      reader.poses = false;
    }
    int reached = 0, refused = 0;
    for (const ConfigEntry& e : before.entries) {
      const auto begins = [&](const std::string& key) { return e.path.starts_with(key); };
      if (left.contains(e.path) || e.set ||
          (e.path == "task.kind" && !kind.settings.empty()) ||  // the settings are of this kind

          std::none_of(kind.keys.begin(), kind.keys.end(), begins)) {
        continue;
      }
      SCOPED_TRACE(e.path);
      const std::string unread = unread_because(e.path, reader);
      if (unread.empty()) {
        ++reached;
        EXPECT_NE(built(with_another(e, kind.settings, reading(kind.use)), kind.use), built_before)
            << "accepted, and without effect";
      } else {
        ++refused;
        EXPECT_THAT(unread, HasSubstr("; expected "));
        if (e.path == "simulator.sensors") continue;  // perception's defaults follow it
        // To look at, it is as it was: that it would not have changed anything is why it is
        // refused.
        EXPECT_EQ(built(with_another(e, kind.settings, reading(Use::kAny)), kind.use), built_before)
            << "refused, but it would have an effect";
      }
    }
    EXPECT_GT(reached + refused, 0);
  }
}

/// What the perception of a recording is made of, as prospect odometry and map do.
std::string perceived(const PerceptionOptions& perception, Use use) {
  Text text;
  text.text.precision(17);
  if (use == Use::kOdometry) {
    text.add_all(perception.odometry), text.add_all(perception.inertial);
  } else if (use == Use::kMapScans) {
    text.add_all(perception.scan_mapping), text.add_all(perception.mapping);
    text.add_all(perception.movers);
  } else {
    DepthMapperOptions mapper = perception.depth_mapping;
    mapper.map = perception.mapping;
    if (use == Use::kMapStereo) {
      set_stereo_accuracy({}, 4.0, mapper);
      mapper.max_speed = StereoOdometryOptions().max_speed;
    }
    text.add_all(mapper), text.add_all(mapper.map), text.add_all(perception.movers);
  }
  return text.text.str();
}

TEST(KeyReaders, EachKeyReachesThePerceptionOfARecordingOrIsRefused) {
  for (const Use use : {Use::kOdometry, Use::kMapDepth, Use::kMapStereo, Use::kMapScans}) {
    SCOPED_TRACE(static_cast<int>(use));
    const auto read = [&](const std::vector<YamlSetting>& settings) {
      return read_perception("", settings, {}, use);
    };
    const std::string before = perceived({}, use);
    int reached = 0;
    for (const ConfigEntry& e : read_configuration("").entries) {
      if (!e.path.starts_with("perception.")) continue;
      SCOPED_TRACE(e.path);
      if (unread_because(e.path, {.use = use}).empty()) {
        ++reached;
        EXPECT_NE(perceived(with_another(e, {}, read), use), before) << "accepted, without effect";
      } else {
        EXPECT_THROW(read({e.path + "=" + e.default_value}), InputError);
        const PerceptionOptions other = with_another(e, {}, reading(Use::kAny)).perception;
        EXPECT_EQ(perceived(other, use), before) << "refused, but it would have an effect";
      }
    }
    EXPECT_GT(reached, 0);
  }
}

// Lists are told whole.
TEST(KeyReaders, EachKeyOfAListReachesWhatIsBuilt) {
  const auto one = [](const std::string& setting) {
    return built(read_configuration("", {}, {setting}, Use::kExplore), Use::kExplore);
  };
  const std::string sphere = "robot.shape={type: spheres, spheres: [{center: [0, 0, 0.3], ";
  EXPECT_NE(one(sphere + "radius: 0.2}]}"), one(sphere + "radius: 0.21}]}"));
  EXPECT_NE(one(sphere + "radius: 0.2}]}"),
            one("robot.shape={type: spheres, spheres: [{center: [0, 0, 0.31], radius: 0.2}]}"));
  const std::string corners = "robot.shape={type: convex, vertices: [0.2, 0, 0.1, -0.2, 0.1, 0.1, ";
  EXPECT_NE(one(corners + "-0.2, -0.1, 0.1, 0, 0, 0.5]}"),
            one(corners + "-0.2, -0.1, 0.1, 0, 0, 0.6]}"));
  EXPECT_NE(one("zones.keep_out=[{area: [5, 5, 6, 5, 6, 6]}]"),
            one("zones.keep_out=[{area: [5.1, 5, 6, 5, 6, 6]}]"));
  EXPECT_NE(one("zones.slow=[{area: [5, 5, 6, 5, 6, 6], max_speed: 0.2}]"),
            one("zones.slow=[{area: [5.1, 5, 6, 5, 6, 6], max_speed: 0.2}]"));
  EXPECT_NE(one("zones.slow=[{area: [5, 5, 6, 5, 6, 6], max_speed: 0.2}]"),
            one("zones.slow=[{area: [5, 5, 6, 5, 6, 6], max_speed: 0.3}]"));
  const auto options = [](const std::string& setting) {
    return read_configuration("", {}, {setting}).planner.solver_options.size();
  };
  EXPECT_EQ(options("planner.options={tolerance: 0.001}"), 1U);
}

// What the file of topics tells is not told by the robot's motion.
TEST(KeyReaders, ARelayReadsTheLimitsThatTheTopicsLeaveOut) {
  const std::vector<ConfigEntry> told =
      read_configuration("", {}, {"robot.motion.a_max=0.5"}, Use::kRelay).entries;
  EXPECT_NO_THROW(refuse_unread(told, {.use = Use::kRelay}));
  EXPECT_THROW(refuse_unread(told, {.use = Use::kRelay, .told_elsewhere = {"robot.motion.a_max"}}),
               InputError);
}

std::vector<std::string> said(const std::string& yaml, const std::vector<YamlSetting>& settings,
                              const KeyReader& reader) {
  try {
    refuse_unread(configuration_from_text(yaml, "f.yaml", {}, settings).entries, reader);
  } catch (const InputError& e) {
    return e.lines();
  }
  return {};
}

TEST(KeyReaders, AFileMayDescribeARobotForAllItsMissions) {
  const KeyReader explore{.use = Use::kExplore};
  // By name of another command; as it is anyway; as a setting.
  EXPECT_THAT(said("drive: {replan_period: 0.4}\ngazebo: {model: mine}\n", {}, explore),
              ElementsAre());
  EXPECT_THAT(said("perception: {odometry: {max_misses: 3}}\n", {}, explore), ElementsAre());
  EXPECT_THAT(said("perception: {odometry:\n  {max_misses: 4}}\n", {}, explore),
              ElementsAre("f.yaml:2: perception.odometry.max_misses: nothing reads it here: of a "
                          "robot with cameras; expected simulator.sensors: camera, or --base "
                          "gazebo|dds"));
  EXPECT_THAT(said("", {"drive.replan_period=0.4"}, explore),
              ElementsAre("--set drive.replan_period=0.4: drive.replan_period: nothing reads it "
                          "here: of a mission in real time; expected it with prospect drive"));
  // What the world and the topics decide.
  const std::vector<YamlSetting> exposed = {"simulator.camera.exposure=2"};
  EXPECT_THAT(said("", exposed, {.use = Use::kExplore, .textured = true}), ElementsAre());
  EXPECT_EQ(said("", exposed, {.use = Use::kExplore, .textured = false}).size(), 1U);
  const std::vector<YamlSetting> spaced = {"perception.scan_mapping.point_spacing=1"};
  EXPECT_THAT(said("", spaced, {.use = Use::kDriveDds, .scans = true}), ElementsAre());
  EXPECT_EQ(said("", spaced, {.use = Use::kDriveDds, .scans = false}).size(), 1U);
  for (const char* key : {"drive.inbox.pose_jump.turn=1", "perception.pose_lost=2"}) {
    EXPECT_THAT(said("", {key}, {.use = Use::kDriveDds}), ElementsAre());
    EXPECT_EQ(said("", {key}, {.use = Use::kDriveDds, .poses = false}).size(), 1U);
  }
  const std::vector<YamlSetting> view = {"robot.depth.horizontal_fov=90"};
  EXPECT_THAT(said("", view, {.use = Use::kDriveDds}), ElementsAre());
  EXPECT_EQ(said("", view, {.use = Use::kDriveDds, .view_told = true}).size(), 1U);
  const std::vector<YamlSetting> rear = {"robot.more_depth=[{mount: {yaw: 180}}]"};
  for (const Use use :
       {Use::kExplore, Use::kDriveDds, Use::kDriveUser, Use::kDriveGazebo, Use::kExport}) {
    EXPECT_THAT(said("", rear, {.use = use}), ElementsAre());
  }
  EXPECT_THAT(said("", spaced, {.use = Use::kDriveUser, .pairs = false}), ElementsAre());
  const std::vector<YamlSetting> cells = {"perception.odometry.corners.cells=60"};
  EXPECT_EQ(said("", cells, {.use = Use::kDriveUser, .pairs = false}).size(), 1U);
  EXPECT_THAT(said("", cells, {.use = Use::kDriveUser}), ElementsAre());
}

TEST(KeyReaders, OfARecordingPerceptionIsRead) {
  const auto cells = [](Use use) {
    return read_perception("", {"perception.odometry.corners.cells=60"}, {}, use)
        .odometry.corners.cells;
  };
  EXPECT_EQ(cells(Use::kOdometry), 60);
  EXPECT_THROW(cells(Use::kMapDepth), InputError);
  for (const char* setting : {"robot.stereo.fx=300", "planner.N=9", "simulator.seed=1"}) {
    EXPECT_THROW(read_perception("", {setting}, {}, Use::kOdometry), InputError) << setting;
  }
}

// The key of a mission by cameras that had no effect once.
TEST(KeyReaders, CornersOfAMissionByCameras) {
  const auto tracked = [](const std::string& setting) {
    const Configuration c =
        read_configuration("", {}, {"simulator.sensors=camera", setting}, Use::kExplore);
    Simulator simulator(std::make_shared<const World>(test::box_room(3.0, 3.0, 2.2, 0.1, 30.0)),
                        c.simulator, c.perception);
    return simulator.sense()->tracked_features;
  };
  try {
    EXPECT_LT(tracked("perception.odometry.corners.cells=60"),
              tracked("perception.odometry.corners.cells=300") - 20);
  } catch (const NotBuiltIn& e) {
    GTEST_SKIP() << e.what();
  }
}

}  // namespace
}  // namespace prospect::key_readers_test

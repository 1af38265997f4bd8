// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/configuration.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/config/read_option.h"
#include "adapters/missions/config/renamed_keys.h"
#include "adapters/missions/config/sensor_sight.h"
#include "adapters/missions/config/solver_options.h"
#include "adapters/missions/config/term_settings.h"
#include "adapters/missions/config/yaml_knobs.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/task/task.h"
#include "engine/task/zones.h"
#include "models/make_model.h"
#include "models/nearest_name.h"
#include "models/range_text.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

StrictYaml with_settings(StrictYaml yaml, const std::vector<YamlSetting>& settings) {
  yaml.rename(renamed_keys());
  for (const YamlSetting& setting : settings) yaml.set(setting);
  yaml.leave_out(gone_keys());
  return yaml;
}

/// A configuration file ("": none), with the settings above it.
StrictYaml document(const std::string& path, const std::vector<YamlSetting>& settings) {
  return with_settings(
      path.empty() ? StrictYaml::from_text("", "defaults") : StrictYaml::from_file(path), settings);
}

/// What the mapping says of it, else as it is.
template <typename Options>
Options read_knobs(YamlMap map, Options options) {
  YamlKnobs knobs(std::move(map));
  describe(knobs, options);
  return options;
}

RobotShape read_shape(YamlMap map) {
  const std::string type =
      map.choice("type", "cylinder", {"cylinder", "box", "spheres", "convex"},
                 "geometry of the body, in the body frame (origin on the floor)");
  if (type == "cylinder") return read_knobs(map, CylinderShape());
  if (type == "box") return read_knobs(map, BoxShape{{0.0, 0.0, 0.3}, {0.4, 0.3, 0.4}});
  if (type == "spheres") {
    SphereSetShape shape;
    for (const YamlMap& sphere : map.maps("spheres")) {
      YamlKnobs knobs(sphere, YamlKnobs::Missing::kError);
      describe(knobs, shape.spheres.emplace_back());
    }
    if (shape.spheres.empty()) {
      map.problem("spheres", "no spheres; expected at least one");
      return CylinderShape{};  // sound, so that one mistake is reported once
    }
    return shape;
  }
  ConvexShape shape;
  const std::size_t problems = map.problem_count();
  const std::vector<double> v =
      map.required_numbers("vertices", -1, -5.0, 5.0, "m", "x, y, z of each vertex in turn");
  if (map.problem_count() != problems) return CylinderShape{};
  if (v.size() % 3 != 0 || v.size() < 12) {
    map.problem("vertices",
                std::to_string(v.size()) + " numbers; expected 3 a vertex, 4 vertices or more");
    return CylinderShape{};
  }
  for (std::size_t i = 0; i + 2 < v.size(); i += 3)
    shape.vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
  return shape;
}

/// A mount by the numbers of CameraMount::forward_facing().
struct MountNumbers {
  Eigen::Vector3d position{0.0, 0.0, 0.45};
  MountAngles angles;

  CameraMount mount() const {
    return {CameraMount::forward_facing(position, angles.yaw, angles.pitch, angles.roll)};
  }
};

void describe(Knobs& knobs, MountNumbers& mount) {
  knobs.numbers("position", mount.position.data(), 3, {-5.0, 5.0}, "m",
                "optical centre in the body frame");
  knobs.degrees("yaw", mount.angles.yaw, {-180.0, 180.0}, "turned from the body's x axis");
  knobs.degrees("pitch", mount.angles.pitch, {-90.0, 90.0}, "optical axis below the horizontal");
  knobs.degrees("roll", mount.angles.roll, {-180.0, 180.0},
                "turned about the optical axis, clockwise as the camera looks");
}

/// Notes what is described below a path in the entries, and makes it what a reader makes of them.
class NotedKnobs final : public Knobs {
 public:
  NotedKnobs(std::string path, std::vector<ConfigEntry>& entries)
      : path_(std::move(path)), entries_(entries) {}

  void number(const char* name, double& value, Range, const char*, const char*) override {
    entry(name).value = exact_text(value);
  }
  void degrees(const char* name, double& radians, Range, const char*) override {
    std::string& text = entry(name).value;
    double value = 0.0;
    if (parse_number(text, value) && kRadiansPerDegree * value == radians) return;
    value = radians / kRadiansPerDegree;
    text = exact_text(value);
    radians = kRadiansPerDegree * value;
  }
  void integer(const char* name, int& value, WholeRange, const char*, const char*) override {
    entry(name).value = exact_text(value);
  }
  void boolean(const char* name, bool& value, const char*) override {
    entry(name).value = value ? "true" : "false";
  }
  void numbers(const char* name, double* values, std::size_t count, Range, const char*,
               const char*) override {
    std::string list;
    for (std::size_t n = 0; n < count; ++n) list += (n > 0 ? ", " : "") + exact_text(values[n]);
    entry(name).value = "[" + list + "]";
  }
  void require(bool, const char*, const char*) override {}

 private:
  void word(const char* name, std::size_t& index, const std::vector<std::string>& words,
            const char*) override {
    entry(name).value = words.at(index);
  }
  void enter(const char* name) override { path_ += std::string(".") + name; }
  void leave() override { path_.resize(path_.rfind('.')); }
  ConfigEntry& entry(const char* name) {
    const std::string path = path_ + "." + name;
    return *std::find_if(entries_.begin(), entries_.end(),
                         [&](const ConfigEntry& e) { return e.path == path; });
  }

  std::string path_;
  std::vector<ConfigEntry>& entries_;
};

void read_robot(YamlMap map, Configuration& c) {
  const std::string name = map.choice("model", "unicycle", model_names(),
                                      "motion model; its parameters stand in `motion`");
  ModelParameters parameters = default_parameters(name);
  YamlKnobs motion(map.map("motion"));
  describe(motion, name, parameters);
  try {
    c.robot.model = make_model(name, parameters);
  } catch (const std::exception& e) {
    map.problem("motion", e.what());
  }
  c.robot.shape = read_shape(map.map("shape"));
  try {
    validate(c.robot.shape);
  } catch (const std::exception& e) {
    map.problem("shape", e.what());
  }

  YamlMap stereo = map.map("stereo");
  c.robot.stereo = read_knobs(stereo, c.robot.stereo);
  c.robot.stereo_mount = read_knobs(stereo.map("mount"), MountNumbers()).mount();

  YamlMap depth = map.map("depth");
  c.robot.depth = read_knobs(depth, c.robot.depth);
  c.robot.depth_mount = read_knobs(depth.map("mount"), MountNumbers()).mount();
  for (YamlMap more : map.maps("more_depth")) {
    DepthSensor& sensor = c.robot.more_depth.emplace_back();
    sensor.footprint = read_knobs(more, RgbdFootprint());
    sensor.mount = read_knobs(more.map("mount"), MountNumbers()).mount();
  }
  if (c.robot.more_depth.size() >= static_cast<std::size_t>(kMostDepthSensors)) {
    map.problem("more_depth", std::to_string(c.robot.more_depth.size()) +
                                  " sensors; expected up to " +
                                  std::to_string(kMostDepthSensors - 1));
    c.robot.more_depth.clear();
  }
}

/// A sensor that sees nothing of where the body drives is refused: the mission would be over at
/// once.
void check_sight(YamlMap robot, const Configuration& c) {
  int number = 0;
  for (const DepthSensor& sensor : c.robot.depth_sensors()) {
    const std::string problem = sight_problem(c.robot, sensor, c.perception.mapping.resolution);
    const int n = number++;
    if (problem.empty()) continue;
    if (n == 0) {
      robot.map("depth").map("mount").problem("position", problem);
    } else {
      robot.problem("more_depth", "sensor " + std::to_string(n) + ": " + problem);
    }
  }
}

/// What the simulated robot shares with the planned one, and the planner with the map.
void share_robot(Configuration& c) {
  c.simulator.shape = c.robot.shape;
  c.simulator.base_height = c.robot.base_height();
  c.simulator.depth.footprint = c.robot.depth;
  set_resolution(c.simulator.depth);
  c.simulator.depth_mount = c.robot.depth_mount;
  c.simulator.more_depth = c.robot.more_depth;
  c.simulator.features.stereo = c.robot.stereo;
  c.simulator.stereo_mount = c.robot.stereo_mount;
  c.planner.map_resolution = c.perception.mapping.resolution;
  c.planner.step = c.perception.mapping.slice.step;
}

/// Returns the paths of settings that others have taken the place of.
std::vector<std::string> read_planner(YamlMap map, const Registries& registries, Configuration& c) {
  c.solver = map.text("solver", c.solver, "back end, see `prospect list solvers`");
  YamlMap options = map.free_map("options", "of the back end, see `prospect list solvers`");
  if (const std::string wrong = solver_problem(c.solver, registries.solvers); !wrong.empty()) {
    map.problem("solver", wrong);
    for (const std::string& name : options.keys()) options.text(name, "", "of the back end");
  } else {
    c.planner.solver_options = read_solver_options(options, *registries.solvers.make(c.solver));
  }
  YamlKnobs knobs(map);
  describe(knobs, c.planner);
  return read_terms(map, registries.terms, c.planner);
}

void read_events(YamlMap map, SimulatorOptions& simulator) {
  constexpr double kMost = 1e9;  // what cannot be is refused as it would be by a robot
  std::vector<ScheduledCorrection>& corrections = simulator.corrections;
  std::vector<ScheduledCorrection> carried;
  const auto read = [&](const char* key, const char* what, CorrectionKind kind,
                        std::vector<ScheduledCorrection>& events) {
    const std::vector<double> told = map.numbers(key, {}, -1, -kMost, kMost, "s, m, m, deg", what);
    if (told.size() % 4 != 0) {
      map.problem(key,
                  std::to_string(told.size()) + " numbers; expected time, x, y and yaw of each");
      return;
    }
    for (std::size_t i = 0; i < told.size(); i += 4) {
      events.push_back({told[i], told[i + 1], told[i + 2], kRadiansPerDegree * told[i + 3], kind});
    }
  };
  read("corrections", "of the map's frame: time, x, y, yaw of each in turn", CorrectionKind::kMap,
       corrections);
  read("robot_corrections", "likewise of the robot's place in what it has drawn",
       CorrectionKind::kRobot, corrections);
  read("carried", "likewise where the robot is carried, to a place of the world",
       CorrectionKind::kRobot, carried);
  for (std::vector<ScheduledCorrection>* events : {&corrections, &carried}) {
    std::stable_sort(events->begin(), events->end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
  }
  for (const ScheduledCorrection& c : carried) {
    simulator.carried.push_back({c.time, {{c.x, c.y, 0.0}, c.yaw}});
  }
}

void read_simulator(YamlMap map, Configuration& c) {
  YamlKnobs knobs(map);
  describe(knobs, c.simulator);
  const std::string known =
      map.text("map", "none", "OctoMap (.bt .ot) of the same world to begin with; none: nothing");
  if (known != "none") c.map = known;
  read_events(std::move(map), c.simulator);
}

void read_perception(YamlMap map, ConfigurationUse use, Configuration& c) {
  const bool camera = c.simulator.sensors == Sensors::kCamera;
  if (camera && (is_simulated(use) || use == ConfigurationUse::kAny)) {
    SimulatorOptions simulator = c.simulator;
    simulator.features.stereo = c.robot.stereo;
    c.perception = simulated_perception(simulator);
  }
  c.perception = read_knobs(std::move(map), c.perception);
}

void read_mission(YamlMap map, Configuration& c) {
  YamlKnobs knobs(map);
  describe(knobs, c.mission);
  YamlKnobs end(map.map("end"));
  describe_end(end, c.planner.frontier_planner);
  YamlMap until = map.map("until");
  c.until_coverage = until.number("coverage", 0.0, 0.0, 1.0, "1",
                                  "share of the reachable area that is enough; 0: all");
  c.until_area = until.number("area", 0.0, 0.0, 1e9, "m2", "area that is enough; 0: all");
}

void read_world(YamlMap map, WorldOptions& world) {
  constexpr double kHighest = 1e5, kFarthest = 1e6;  // [m]
  const std::string floor =
      map.text("floor", "lowest",
               "storey, by the height of its ground in the file [m]; lowest: the lowest large one");
  if (floor != "lowest") {
    double height = 0.0;
    if (!parse_number(floor, height) || !(std::abs(height) <= kHighest)) {
      map.problem("floor",
                  "is '" + floor + "'; expected lowest or a number from -100000 to 100000");
    } else {
      world.floor = height;
    }
  }
  world.voxel_size =
      map.number("resolution", 0.0, 0.01, 10.0, "m",
                 "size of its voxels; of an image without .yaml: of a pixel; 0: 0.1 m, "
                 "of meshes 0.05 m");
  world.unknown_is_free = map.choice("unknown", "solid", {"solid", "free"},
                                     "what the world's file does not know") == "free";
  world.ground_margin =
      map.number("ground", 0.0, 0.0, 1000.0, "m",
                 "how far ground without end counts beyond what stands on it; 0: as far as that");
  const std::string up =
      map.choice("up", "file", {"file", "x", "y", "z"},
                 "of a mesh: the axis of its numbers that is up; file: as it says");
  if (up != "file") world.up = static_cast<UpAxis>(up[0] - 'x');
  const std::vector<double> start =
      map.numbers("start", {}, -1, -kFarthest, kFarthest, "m, m, deg",
                  "where the robot starts: x, y, yaw; none: as the world says");
  if (start.size() == 3) {
    world.start = Pose{{start[0], start[1], 0.0}, start[2] * M_PI / 180.0};  // as --start does
  } else if (!start.empty()) {
    map.problem("start", std::to_string(start.size()) + " numbers; expected x, y and yaw");
  }
}

void read_drive(YamlMap map, Configuration& c) {
  YamlKnobs knobs(map);
  describe(knobs, c.drive);
  c.simulated_base = read_knobs(map.map("simulator"), c.simulated_base);
}

void read_gazebo(YamlMap map, GazeboOptions& gazebo) {
  gazebo.address.host = map.text("host", gazebo.address.host, "of Gazebo's master");
  gazebo = read_knobs(map, gazebo);
  const std::string world = map.text("world", "running", "its name; running: the one that runs");
  gazebo.world = world == "running" ? "" : world;
  gazebo.model = map.text("model", gazebo.model, "the robot, with the plug-in DiffDrivePlugin");
  gazebo.link = map.text("link", gazebo.link, "of the model, which bears the sensors");
  gazebo.stereo = map.text("stereo", gazebo.stereo, "sensor multicamera: left, then right");
  const std::string depth = map.text("depth", gazebo.depth, "sensor depth; none: there is none");
  gazebo.depth = depth == "none" ? "" : depth;
  const std::string imu = map.text("imu", gazebo.imu.empty() ? "none" : gazebo.imu,
                                   "sensor imu at the link's origin; none: there is none");
  gazebo.imu = imu == "none" ? "" : imu;
  gazebo.left_wheel = map.text("left_wheel", gazebo.left_wheel, "link of the model");
  gazebo.right_wheel = map.text("right_wheel", gazebo.right_wheel, "link of the model");
}

/// What the drivers of a robot of one's own are told. Where it is not there, as for a replay, its
/// keys stay as they are.
void read_base(YamlMap map, const Registries& registries, Options& base) {
  for (const OfferedRobot& offered : registries.robots) {
    for (const OptionInfo& option : offered.robot.options)
      base[option.name] = read_option(map, option);
  }
  if (!registries.robots.empty()) return;
  for (const std::string& name : map.keys()) map.value(name, "of a robot's own driver");
}

/// x, y of each corner in turn.
Polygon polygon_of(const std::vector<double>& numbers) {
  Polygon polygon;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    polygon.emplace_back(numbers[i], numbers[i + 1]);
  }
  return polygon;
}

constexpr double kFarthestPlace = 1e5;  // [m]

/// Records what is wrong with the polygon under the key.
Polygon read_polygon(YamlMap map, const char* key, bool required, const char* what) {
  const std::size_t problems = map.problem_count();
  const std::vector<double> numbers =
      required ? map.required_numbers(key, -1, -kFarthestPlace, kFarthestPlace, "m", what)
               : map.numbers(key, {}, -1, -kFarthestPlace, kFarthestPlace, "m", what);
  if (map.problem_count() != problems || (numbers.empty() && !required)) return {};
  if (numbers.size() % 2 != 0) {
    map.problem(key, std::to_string(numbers.size()) + " numbers; expected x and y of each corner");
    return {};
  }
  Polygon polygon = polygon_of(numbers);
  if (const std::string fault = polygon_fault(polygon); !fault.empty()) map.problem(key, fault);
  return polygon;
}

void read_zones(YamlMap map, Zones& zones) {
  const char* corners = "x, y of each corner in turn";
  Polygon bound =
      read_polygon(map, "bound", false, "the robot stays within: x, y of each corner in turn");
  if (!bound.empty()) zones.bound = std::move(bound);
  for (const YamlMap& zone : map.maps("keep_out")) {
    zones.keep_out.push_back(read_polygon(zone, "area", true, corners));
  }
  for (YamlMap zone : map.maps("slow")) {
    SpeedZone slow;
    slow.area = read_polygon(zone, "area", true, corners);
    slow.max_speed = zone.required_number("max_speed", 0.01, 100.0, "m/s", "allowed there");
    zones.slow.push_back(std::move(slow));
  }
}

void read_task(YamlMap map, Configuration& c) {
  Task& task = c.planner.task;
  const std::string kind =
      map.choice("kind", "explore", {"explore", "go", "return", "hold"}, "what the robot is to do");
  Polygon area = read_polygon(map, "area", false,
                              "of explore: only what lies in there; x, y of each corner in turn");
  const std::vector<double> goal = map.numbers("goal", {}, -1, -kFarthestPlace, kFarthestPlace,
                                               "m, m, deg", "of go: x, y and, if it matters, yaw");
  task.goal.position_tolerance = map.number("position_tolerance", task.goal.position_tolerance,
                                            0.05, 10.0, "m", "of go and return: how near is there");
  task.goal.yaw_tolerance =
      kRadiansPerDegree * map.number("yaw_tolerance",
                                     std::round(task.goal.yaw_tolerance / kRadiansPerDegree), 2.0,
                                     180.0, "deg", "of go and return");
  if (goal.size() >= 2) task.goal.position = {goal[0], goal[1]};
  if (goal.size() >= 3) task.goal.yaw = kRadiansPerDegree * goal[2];
  if (!area.empty() && kind == "explore") task.area = std::move(area);
  task.kind = kind == "go"       ? TaskKind::kGoTo
              : kind == "return" ? TaskKind::kReturn
              : kind == "hold"   ? TaskKind::kHold
                                 : TaskKind::kExplore;
  if (goal.size() == 1 || goal.size() > 3 || (goal.empty() && kind == "go")) {
    map.problem("goal", std::to_string(goal.size()) +
                            " numbers; expected x, y, and yaw if it "
                            "matters");
  }
}

/// What the robot and the parameters of a planner must agree in is the planner's to know.
std::string planner_problem(const Configuration& c, const Registries& registries) {
  try {
    Planner(c.robot, c.planner, registries.solvers.make(c.solver));
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

Configuration read(StrictYaml yaml, const Registries& registries, ConfigurationUse use) {
  Configuration c;
  YamlMap root = yaml.root();
  read_robot(root.map("robot"), c);
  const std::vector<std::string> replaced = read_planner(root.map("planner"), registries, c);
  read_simulator(root.map("simulator"), c);
  read_perception(root.map("perception"), use, c);
  read_world(root.map("world"), c.world);
  c.guard = read_knobs(root.map("guard"), c.guard);
  read_mission(root.map("mission"), c);
  read_task(root.map("task"), c);
  read_zones(root.map("zones"), c.planner.zones);
  // A robot that is refused has no outline.
  if (root.problem_count() == 0) c.drive.ranges = range_stop_options(c.robot);
  read_drive(root.map("drive"), c);
  read_gazebo(root.map("gazebo"), c.gazebo);
  read_base(root.map("base"), registries, c.base);
  if (root.problem_count() == 0) check_sight(root.map("robot"), c);
  if (root.problem_count() == 0) {
    share_robot(c);
    if (const std::string fault = task_problem(c); !fault.empty())
      // "goal: is in ...": where the goal is told.
      root.map("task").problem(fault.substr(0, fault.find(':')), fault.substr(fault.find(':') + 2));
    else if (const std::string unfit = planner_problem(c, registries); !unfit.empty())
      root.map("planner").problem("", unfit);
  }
  yaml.finish();

  c.entries = yaml.entries();
  c.notices = yaml.notices();
  std::erase_if(c.entries, [&](const ConfigEntry& entry) {
    return std::find(replaced.begin(), replaced.end(), entry.path) != replaced.end();
  });
  refuse_unread(c.entries, key_reader(c, use));
  return c;
}

}  // namespace

KeyReader key_reader(const Configuration& c, ConfigurationUse use) {
  return {.use = use,
          .sensors = c.simulator.sensors,
          .wheels = c.perception.wheels,
          .task = c.planner.task.kind};
}

std::string task_problem(const Configuration& configuration) {
  const FrontierPlannerOptions frontier_planner =
      frontier_planner_options_for(configuration.robot, configuration.planner);
  const std::vector<std::string> wrong =
      faults(configuration.planner.task, frontier_planner.traversability.zones.get(),
             frontier_planner.traversability.hard_radius);
  return wrong.empty() ? "" : wrong.front();
}

void set_cameras(Configuration& configuration, const RobotDescription& robot,
                 const std::string& told_by) {
  Configuration told = configuration;
  const auto noted = [&](const std::string& path, auto numbers) {
    try {
      check_knobs(told_by + ": " + path, numbers);
    } catch (const std::invalid_argument& e) {
      throw InputError(e.what());
    }
    NotedKnobs knobs(path, told.entries);
    describe(knobs, numbers);
    return numbers;
  };
  // The angles of a mount are not unique: what is the same keeps those of the file.
  const auto note_mount = [&](const std::string& path, const CameraMount& mount,
                              CameraMount& before) {
    if (mount.T_BC.matrix() == before.T_BC.matrix()) return;
    before = noted(path, MountNumbers{mount.T_BC.translation(), angles(mount)}).mount();
  };
  told.robot.stereo = noted("robot.stereo", robot.stereo);
  note_mount("robot.stereo.mount", robot.stereo_mount, told.robot.stereo_mount);
  told.robot.depth = noted("robot.depth", robot.depth);
  note_mount("robot.depth.mount", robot.depth_mount, told.robot.depth_mount);
  for (std::size_t n = 0; n < robot.more_depth.size(); ++n) {
    const std::string path = "robot.more_depth[" + std::to_string(n) + "]";
    if (n >= told.robot.more_depth.size()) {
      throw InputError(told_by + ": " + path +
                       ": the configuration has none; expected it there, {} at least");
    }
    DepthSensor& sensor = told.robot.more_depth[n];
    sensor.footprint = noted(path, robot.more_depth[n].footprint);
    note_mount(path + ".mount", robot.more_depth[n].mount, sensor.mount);
  }
  std::string path = "robot.depth";
  int number = 0;
  for (const DepthSensor& sensor : told.robot.depth_sensors()) {
    const std::string blind = sight_problem(told.robot, sensor, told.perception.mapping.resolution);
    if (!blind.empty()) throw InputError(told_by + ": " + path + ".mount.position: " + blind);
    path = "robot.more_depth[" + std::to_string(number++) + "]";
  }
  share_robot(told);
  configuration = std::move(told);
}

std::string solver_problem(const std::string& name, const SolverRegistry& solvers) {
  try {
    solvers.make(name);
    return "";
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
}

Configuration read_configuration(const std::string& path, const Registries& registries,
                                 const std::vector<YamlSetting>& settings, ConfigurationUse use) {
  return read(document(path, settings), registries, use);
}

PerceptionOptions read_perception(const std::string& path, const std::vector<YamlSetting>& settings,
                                  const PerceptionOptions& defaults, ConfigurationUse use,
                                  std::vector<std::string>* notices) {
  for (const YamlSetting& setting : settings) {
    if (setting.assignment.starts_with("perception.")) continue;
    throw InputError("--set " + setting.assignment +
                     ": of a robot, not of a recording; expected a key of perception");
  }
  StrictYaml yaml = document(path, settings);
  YamlMap root = yaml.root();
  PerceptionOptions perception = read_knobs(root.map("perception"), defaults);
  root.leave_rest();
  yaml.finish();
  std::vector<ConfigEntry> told = yaml.entries();
  std::erase_if(told, [](const ConfigEntry& entry) { return !entry.set; });
  refuse_unread(told, {.use = use});
  if (notices) *notices = yaml.notices();
  return perception;
}

Configuration configuration_from_text(const std::string& text, const std::string& source,
                                      const Registries& registries,
                                      const std::vector<YamlSetting>& settings) {
  return read(with_settings(StrictYaml::from_text(text, source), settings), registries,
              ConfigurationUse::kAny);
}

}  // namespace prospect

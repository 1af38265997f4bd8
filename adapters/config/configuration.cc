#include "adapters/config/configuration.h"

#include <cmath>
#include <exception>
#include <stdexcept>

#include "adapters/files/input_error.h"
#include "engine/task/task.h"
#include "engine/task/zones.h"
#include "models/make_model.h"
#include "models/nearest_name.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr double kDegree = M_PI / 180.0;

Eigen::Vector3d vector3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

RobotShape read_shape(YamlMap map) {
  const std::string type =
      map.choice("type", "cylinder", {"cylinder", "box", "spheres", "convex"},
                 "geometry of the body, in the body frame (origin on the floor)");
  if (type == "cylinder") {
    CylinderShape shape;
    shape.radius = map.number("radius", shape.radius, 0.01, 5.0, "m", "radius about the axis");
    shape.height = map.number("height", shape.height, 0.01, 5.0, "m", "height");
    shape.center = vector3(map.numbers("center", {0.0, 0.0, 0.3}, 3, -5.0, 5.0, "m", "centre"));
    return shape;
  }
  if (type == "box") {
    BoxShape shape;
    shape.size = vector3(map.numbers("size", {0.4, 0.3, 0.4}, 3, 0.01, 10.0, "m", "edge lengths"));
    shape.center = vector3(map.numbers("center", {0.0, 0.0, 0.3}, 3, -5.0, 5.0, "m", "centre"));
    return shape;
  }
  if (type == "spheres") {
    SphereSetShape shape;
    for (YamlMap sphere : map.maps("spheres")) {
      shape.spheres.push_back(
          {vector3(sphere.required_numbers("center", 3, -5.0, 5.0, "m", "centre")),
           sphere.required_number("radius", 0.01, 5.0, "m", "radius")});
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

CameraMount read_mount(YamlMap map) {
  CameraMount mount;
  const Eigen::Vector3d position = vector3(map.numbers("position", {0.0, 0.0, 0.45}, 3, -5.0, 5.0,
                                                       "m", "optical centre in the body frame"));
  const double yaw = map.number("yaw", 0.0, -180.0, 180.0, "deg", "turned from the body's x axis");
  const double pitch =
      map.number("pitch", 0.0, -89.0, 89.0, "deg", "optical axis below the horizontal");
  mount.T_BC = CameraMount::forward_facing(position, yaw * kDegree, pitch * kDegree);
  return mount;
}

void read_robot(YamlMap map, Configuration& c) {
  const std::string name = map.choice("model", "unicycle", model_names(),
                                      "motion model; its parameters stand in `motion`");
  ModelParameters parameters = default_parameters(name);
  YamlMap motion = map.map("motion");
  for (auto& [key, value] : parameters) {
    value = motion.number(key, value, -1e3, 1e3, "SI", "parameter of the motion model");
  }
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
  StereoCamera& s = c.robot.stereo;
  s.left.fx = stereo.number("fx", s.left.fx, 1.0, 1e5, "px", "focal length");
  s.left.fy = stereo.number("fy", s.left.fy, 1.0, 1e5, "px", "focal length");
  s.left.cx = stereo.number("cx", s.left.cx, 0.0, 1e5, "px", "principal point");
  s.left.cy = stereo.number("cy", s.left.cy, 0.0, 1e5, "px", "principal point");
  s.left.width = stereo.number("width", s.left.width, 16.0, 1e5, "px", "image width");
  s.left.height = stereo.number("height", s.left.height, 16.0, 1e5, "px", "image height");
  s.baseline =
      stereo.number("baseline", s.baseline, 0.001, 10.0, "m", "distance of the two cameras");
  s.sigma_u = stereo.number("sigma_u", s.sigma_u, 0.01, 50.0, "px", "image noise");
  s.sigma_v = stereo.number("sigma_v", s.sigma_v, 0.01, 50.0, "px", "image noise");
  s.sigma_d = stereo.number("sigma_d", s.sigma_d, 0.01, 50.0, "px", "disparity noise");
  c.robot.stereo_mount = read_mount(stereo.map("mount"));

  YamlMap depth = map.map("depth");
  RgbdFootprint& f = c.robot.depth;
  f.horizontal_fov = kDegree * depth.number("horizontal_fov", f.horizontal_fov / kDegree, 1.0,
                                            360.0, "deg", "horizontal field of view");
  f.vertical_fov =
      kDegree * depth.number("vertical_fov", f.vertical_fov / kDegree, 0.0, 180.0, "deg",
                             "vertical field of view; 0: a single layer of rays");
  f.min_range = depth.number("min_range", f.min_range, 0.0, 100.0, "m", "nearest measured range");
  f.max_range = depth.number("max_range", f.max_range, 0.5, 100.0, "m", "farthest measured range");
  if (!(f.max_range > f.min_range))
    depth.problem("max_range", "max_range <= min_range; expected more");
  c.robot.depth_mount = read_mount(depth.map("mount"));
}

void read_planner(YamlMap map, const SolverRegistry& solvers, Configuration& c) {
  PlannerParameters& p = c.planner;
  const auto number = [&](const char* key, double& value, double min, double max, const char* unit,
                          const char* what) {
    value = map.number(key, value, min, max, unit, what);
  };
  const auto integer = [&](const char* key, int& value, int min, int max, const char* what) {
    value = static_cast<int>(map.integer(key, value, min, max, "1", what));
  };
  c.solver = map.text("solver", c.solver, "back end, see `prospect list solvers`");
  if (const std::string wrong = solver_problem(c.solver, solvers); !wrong.empty()) {
    map.problem("solver", wrong);
  }
  integer("N", p.N, 1, 1000, "stages of the horizon");
  number("dt", p.dt, 0.01, 5.0, "s", "duration of a stage");
  integer("M", p.M, 1, 1000, "knots (move blocking), at most N");
  if (p.M > p.N) map.problem("M", "more knots than stages; expected at most N");
  number("committed", p.committed, 0.01, 60.0, "s", "certified and executed before the next plan");
  number("deadline", p.deadline, 0.0, 60.0, "s",
         "wall-clock limit of a planning step; 0: none, runs are reproducible");
  integer("polished", p.polished, 0, 100, "seeds handed to the solver");
  integer("polish_evaluations", p.polish_evaluations, 1, 1000000, "evaluations of each");
  integer("threads", p.threads, 1, 256,
          "that share a planning step; the same plans for any number");

  YamlMap w = map.map("weights");
  p.w_u = w.number("w_u", p.w_u, 0.0, 1e6, "1", "deviation from the desired input");
  p.w_du = w.number("w_du", p.w_du, 0.0, 1e6, "1", "change of input");
  p.w_o = w.number("w_o", p.w_o, 0.0, 1e6, "1", "closeness to obstacles");
  p.w_l = w.number("w_l", p.w_l, 0.0, 1e6, "1", "too few visible features");
  p.w_e = w.number("w_e", p.w_e, 0.0, 1e6, "1", "exploration gain");
  p.w_T = w.number("w_T", p.w_T, 0.0, 1e6, "1", "cost-to-go");
  p.w_h = w.number("w_h", p.w_h, 0.0, 1e6, "1", "heading alignment");
  p.w_c = w.number("w_c", p.w_c, 0.0, 1e6, "1",
                   "chance penalty on visible features; counts only if w_l > 0");
  number("desired_speed", p.desired_speed, 0.0, 1.0, "1", "share of the largest speed");
  number("d_safe", p.d_safe, 0.0, 5.0, "m", "hard clearance");
  number("d_des", p.d_des, 0.01, 5.0, "m", "clearance beyond which closeness costs nothing");
  if (!(p.d_des > p.d_safe)) map.problem("d_des", "d_des <= d_safe; expected more");
  number("certificate_margin", p.certificate_margin, 0.001, 1.0, "m",
         "by which the certified body is grown");
  number("drift_margin", p.drift_margin, 0.0, 1.0, "m",
         "kept besides, at most, from surfaces that may have drifted since they were in view");
  number("drift_limit", p.drift_limit, 0.0, 1.0, "m",
         "drift since it was in view beyond which space counts as unknown; 0: none does");
  number("lost_margin", p.lost_margin, 0.0, 1.0, "m",
         "kept from obstacles while localization is lost; 0: no more than else");
  const std::string unknown = map.choice("unknown", "braking", {"free", "blocked", "braking"},
                                         "what unknown space means to motion");
  p.unknown = unknown == "free"      ? UnknownPolicy::kFree
              : unknown == "blocked" ? UnknownPolicy::kBlocked
                                     : UnknownPolicy::kBraking;

  YamlMap v = map.map("visibility");
  integer("max_landmarks", p.max_landmarks, 0, 100000, "landmarks considered");
  integer("max_targets", p.max_targets, 0, 300, "exploration targets considered");
  p.features.N_req = v.number("N_req", p.features.N_req, 1.0, 1e4, "1", "features that suffice");
  p.features.N_min = v.number("N_min", p.features.N_min, 1.0, 1e4, "1",
                              "features below which odometry is not to be trusted");
  const std::string criterion = v.choice(
      "criterion", p.features.criterion == VisibilityCriterion::kCount ? "count" : "information",
      {"count", "information"}, "number of points, or what they tell about the pose");
  p.features.criterion =
      criterion == "count" ? VisibilityCriterion::kCount : VisibilityCriterion::kInformation;
  p.feature_prior = v.boolean("prior", p.feature_prior, "count features expected in unknown space");
  p.visibility.r_min =
      v.number("r_min", p.visibility.r_min, 0.05, 100.0, "m", "nearest useful depth");
  p.visibility.r_max =
      v.number("r_max", p.visibility.r_max, 0.5, 1000.0, "m", "farthest useful depth");
  p.visibility_lattice =
      v.number("lattice", p.visibility_lattice, 0.05, 2.0, "m", "spacing of the occlusion tables");
  p.unknown_attenuation = v.number("attenuation", p.unknown_attenuation, 0.0, 100.0, "1/m",
                                   "of rays to targets through unknown space");
  p.feature_attenuation = v.number("feature_attenuation", p.feature_attenuation, 0.0, 100.0, "1/m",
                                   "of rays to features through unknown space");
  p.feature_occlusion =
      v.boolean("occlusion", p.feature_occlusion, "walls hide features; false: for ablations");
  p.feature_covariance = v.boolean("covariance", p.feature_covariance,
                                   "landmarks and motion are uncertain; false: for ablations");

  YamlMap r = map.map("recovery");
  p.behaviour.retreat_time =
      r.number("time", p.behaviour.retreat_time, 0.0, 600.0, "s", "longest single attempt");
  p.behaviour.turn_time = r.number("turn", p.behaviour.turn_time, 0.0, 600.0, "s",
                                   "on the spot, if still lost after it");
  p.behaviour.retreat_pause =
      r.number("pause", p.behaviour.retreat_pause, 0.0, 3600.0, "s", "before the next attempt");
  p.behaviour.lost_patience =
      r.number("patience", p.behaviour.lost_patience, 0.0, 3600.0, "s",
               "in the pause, that a robot which got lost anew explores on");

  YamlMap f = map.map("frontiers");
  FrontierPlannerOptions& g = p.frontier_planner;
  g.frontiers.min_length = f.number("min_length", g.frontiers.min_length, 0.0, 10.0, "m",
                                    "smallest cluster of frontier cells");
  g.frontiers.range_margin = f.number("range_margin", g.frontiers.range_margin, 0.0, 10.0, "m",
                                      "a viewpoint stands this much within the sensor's range");
  g.worth.depth =
      f.number("depth", g.worth.depth, 0.0, 10.0, "m", "how far behind a frontier its area counts");
  g.worth.opening = f.number("opening", g.worth.opening, 0.0, 1.0, "m",
                             "clearance of unknown ground that counts");
  g.order.horizon =
      f.number("horizon", g.order.horizon, 0.1, 1e4, "m",
               "of way in which what is still to be seen loses a factor of e in worth");
  g.order.every_look = f.number("every_look", g.order.every_look, 0.0, 100.0, "m2",
                                "that a frontier counts besides its area");
  g.commitment = f.number("commitment", g.commitment, 0.0, 100.0, "1",
                          "share by which another sequence must be better to change the target");
  g.cost_to_go.lambda =
      f.number("lambda", g.cost_to_go.lambda, 0.0, 1000.0, "1",
               "price of ways on which no feature is seen; 0: none, as with w_l = 0");
  g.traversability.narrow_factor =
      f.number("narrow_factor", g.traversability.narrow_factor, 4.0, 1e4, "1",
               "cost of a metre through what is narrower than the robot keeps clear");
}

// What `sensors: camera` needs besides.
void read_camera(YamlMap map, CameraSensorsOptions& c) {
  const auto number = [&](const char* key, double& value, double max, const char* unit,
                          const char* what) {
    value = map.number(key, value, 0.0, max, unit, what);
  };
  number("texture_quality", c.texture_quality, 1.0, "1", "contrast of surfaces, 0 blank to 1 rich");
  c.focal_error = map.number("focal_error", c.focal_error, -0.9, 9.0, "1",
                             "by which the stereo pair's focal length is believed too large");
  c.baseline_error = map.number("baseline_error", c.baseline_error, -0.9, 9.0, "1",
                                "by which its baseline is believed too large");
  number("exposure", c.rig.exposure, 100.0, "1", "gain on the grey levels");
  number("exposure_time", c.rig.exposure_time, 1.0, "s", "motion blur of a turning robot");
  number("vignetting", c.rig.vignetting, 1.0, "1", "share of light lost in the corners");
  number("blur", c.rig.blur, 20.0, "px", "of the lens, one standard deviation");
  number("read_noise", c.rig.read_noise, 100.0, "1", "grey levels, one standard deviation");
  number("shot_noise", c.rig.shot_noise, 100.0, "1", "variance a grey level");
  c.rig.threads = static_cast<int>(map.integer("threads", c.rig.threads, 1, 256, "1",
                                               "of the renderer; the same bits with any"));
  c.wheels = map.boolean("wheels", c.wheels, "wheel odometry, fused with what the images say");
}

void read_simulator(YamlMap map, Configuration& c) {
  SimulatorOptions& s = c.simulator;
  const std::string sensors =
      map.choice("sensors", "model", {"model", "camera"},
                 "odometry as a model of its errors, or rendered images through perception");
  s.sensors = sensors_named(sensors);
  s.mapping.resolution = map.number("map_resolution", s.mapping.resolution, 0.02, 1.0, "m",
                                    "of the map that is built");
  const std::string known =
      map.text("map", "none", "OctoMap (.bt .ot) of the same world to begin with; none: nothing");
  if (known != "none") c.map = known;
  s.depth_rate = map.number("depth_rate", s.depth_rate, 0.1, 100.0, "1/s", "depth images");
  s.image_rate = map.number("image_rate", s.image_rate, 0.1, 100.0, "1/s", "stereo images");
  YamlMap a = map.map("actuation");
  s.actuation.linear =
      a.number("linear", s.actuation.linear, 0.0, 1.0, "sqrt(s)", "noise of the distance");
  s.actuation.angular =
      a.number("angular", s.actuation.angular, 0.0, 1.0, "sqrt(s)", "noise of the angle");
  s.actuation.coupling = a.number("coupling", s.actuation.coupling, 0.0, 1.0, "rad sqrt(s)/m",
                                  "noise of the heading from driving");
  YamlMap o = map.map("odometry");
  s.odometry.perfect = o.boolean("perfect", s.odometry.perfect, "the estimate is the truth");
  s.odometry.position_sigma = o.number("position_sigma", s.odometry.position_sigma, 0.0, 1.0, "m",
                                       "error of a keyframe at 200 points");
  s.odometry.heading_sigma = o.number("heading_sigma", s.odometry.heading_sigma, 0.0, 1.0, "rad",
                                      "error of a keyframe at 200 points");
  s.odometry.lost_below = static_cast<int>(
      o.integer("lost_below", s.odometry.lost_below, 0, 10000, "1", "tracked points: lost"));
  s.odometry.degraded_below = static_cast<int>(o.integer(
      "degraded_below", s.odometry.degraded_below, 0, 10000, "1", "tracked points: degraded"));
  s.odometry.reckoning_distance =
      o.number("reckoning_distance", s.odometry.reckoning_distance, 0.0, 1.0, "1",
               "error of the wheels while lost, share of the distance");
  s.odometry.reckoning_angle = o.number("reckoning_angle", s.odometry.reckoning_angle, 0.0, 1.0,
                                        "1", "error of the wheels while lost, share of the angle");
  s.odometry.reckoning_heading =
      o.number("reckoning_heading", s.odometry.reckoning_heading, 0.0, 1.0, "rad/m",
               "error of the wheels while lost, of the heading");
  read_camera(map.map("camera"), s.camera);
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
  for (YamlMap zone : map.maps("keep_out")) {
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
      kDegree * map.number("yaw_tolerance", std::round(task.goal.yaw_tolerance / kDegree), 2.0,
                           180.0, "deg", "of go and return");
  if (goal.size() >= 2) task.goal.position = {goal[0], goal[1]};
  if (goal.size() >= 3) task.goal.yaw = kDegree * goal[2];
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

Configuration read(StrictYaml yaml, const SolverRegistry& solvers) {
  Configuration c;
  YamlMap root = yaml.root();
  read_robot(root.map("robot"), c);
  read_planner(root.map("planner"), solvers, c);
  read_simulator(root.map("simulator"), c);
  YamlMap mission = root.map("mission");
  c.mission.time_limit =
      mission.number("time_limit", c.mission.time_limit, 1.0, 1e6, "s", "of the robot's clock");
  c.mission.lost_limit = mission.number("lost_limit", c.mission.lost_limit, 0.0, 1e6, "s",
                                        "without localization that ends the mission");
  YamlMap end = mission.map("end");
  FrontierPlannerOptions& frontier_planner = c.planner.frontier_planner;
  frontier_planner.least_area = end.number("least_area", frontier_planner.least_area, 0.0, 1e4,
                                           "m2", "a frontier that promises less is not gone to");
  frontier_planner.least_rate =
      end.number("least_rate", frontier_planner.least_rate, 0.0, 1e3, "m2/s",
                 "nor one that shows less for the time that it takes");
  c.mission.return_when_done = mission.boolean("return", c.mission.return_when_done,
                                               "back to the start once the task is over");
  YamlMap until = mission.map("until");
  c.until_coverage = until.number("coverage", 0.0, 0.0, 1.0, "1",
                                  "share of the reachable area that is enough; 0: all");
  c.until_area = until.number("area", 0.0, 0.0, 1e9, "m2", "area that is enough; 0: all");
  read_task(root.map("task"), c);
  read_zones(root.map("zones"), c.planner.zones);
  if (root.problem_count() == 0) {
    if (const std::string fault = task_problem(c); !fault.empty())
      root.map("task").problem("", fault);
  }
  yaml.finish();

  // What the simulated robot shares with the planned one.
  c.simulator.shape = c.robot.shape;
  c.simulator.base_height = c.robot.base_height();
  c.simulator.depth.footprint = c.robot.depth;
  set_resolution(c.simulator.depth);
  c.simulator.depth_mount = c.robot.depth_mount;
  c.simulator.features.stereo = c.robot.stereo;
  c.simulator.stereo_mount = c.robot.stereo_mount;
  c.entries = yaml.entries();
  return c;
}

}  // namespace

std::string task_problem(const Configuration& configuration) {
  const FrontierPlannerOptions frontier_planner =
      frontier_planner_options_for(configuration.robot, configuration.planner);
  const std::vector<std::string> wrong =
      faults(configuration.planner.task, frontier_planner.traversability.zones.get(),
             frontier_planner.traversability.hard_radius);
  return wrong.empty() ? "" : wrong.front();
}

void override_entry(Configuration& configuration, const std::string& path,
                    const std::string& value) {
  for (ConfigEntry& entry : configuration.entries) {
    if (entry.path == path) entry.value = value;
  }
}

std::string solver_problem(const std::string& name, const SolverRegistry& solvers) {
  try {
    solvers.make(name);
    return "";
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
}

Configuration read_configuration(const std::string& path, const SolverRegistry& solvers,
                                 const std::vector<std::string>& settings) {
  StrictYaml yaml =
      path.empty() ? StrictYaml::from_text("", "defaults") : StrictYaml::from_file(path);
  for (const std::string& setting : settings) yaml.set(setting);
  return read(std::move(yaml), solvers);
}

Configuration configuration_from_text(const std::string& text, const std::string& source,
                                      const SolverRegistry& solvers) {
  return read(StrictYaml::from_text(text, source), solvers);
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_options.h"

#include <set>
#include <string>
#include <utility>

#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/robots/dds/dds_names.h"
#include "models/robot_description.h"

namespace prospect {
namespace {

/// Reads names of topics, each once, those of a namespace ("" or "/NS") in full.
class TopicReader {
 public:
  enum class Empty { kAllowed, kRefused };
  /// `rules` outlives it.
  TopicReader(NameRules& rules, const DdsAddress& node)
      : rules_(rules), namespace_(node.its_namespace), node_(node.node) {}
  std::string read(YamlMap map, const std::string& key, const std::string& default_value,
                   const std::string& what, Empty empty) {
    std::string name =
        map.text(key, default_value.empty() ? "none" : namespace_ + default_value, what);
    if (name == "none") name.clear();
    if (!namespace_.empty() && !name.empty()) {
      name = NameRules::resolved(name, namespace_, node_);
    }
    if (!name.empty()) name = rules_.remapped(name, namespace_, node_);
    if (name.empty()) {
      if (empty == Empty::kRefused) map.problem(key, "it is none; expected a topic");
      return name;
    }
    const std::string problem = topic_problem(name);
    if (!problem.empty()) {
      map.problem(key, problem);
    } else if (!used_.insert(name).second) {
      map.problem(key, "'" + name + "' has another meaning already; expected a topic of its own");
    }
    return name;
  }

 private:
  NameRules& rules_;
  const std::string namespace_, node_;
  std::set<std::string> used_;
};

std::string read_namespace(YamlMap root) {
  std::string name = root.text("namespace", "none", "of topics that do not begin with a slash");
  if (name == "none" || name == "/") return "";
  if (!name.starts_with("/")) name.insert(0, "/");
  while (name.ends_with("/")) name.pop_back();
  const std::string problem = topic_problem(name);
  if (!problem.empty()) root.problem("namespace", problem);
  return name;
}

DdsAddress read_address(YamlMap root, const RosArguments& arguments) {
  DdsAddress a;
  a.domain = static_cast<int>(root.integer("domain", a.domain, 0, 232, "1", "as ROS_DOMAIN_ID"));
  a.node = root.text("node", a.node, "name of this node");
  const std::string problem = topic_problem("/" + a.node);
  if (!problem.empty() || a.node.find('/') != std::string::npos) {
    root.problem("node", "'" + a.node + "'; expected a name of ROS 2 such as prospect");
  }
  a.its_namespace = read_namespace(root);
  a.loopback = root.boolean("loopback", a.loopback, "this machine alone");
  a.configuration = root.text("configuration", "none", "file of CycloneDDS's XML");
  if (a.configuration == "none") a.configuration.clear();
  if (a.configuration.empty() && !a.loopback) a.uri = arguments.cyclonedds_uri;
  return a;
}

void read_clock(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  o.use_sim_time = root.boolean("use_sim_time", o.use_sim_time, "time is that of the topic clock");
  o.clock = topics.read(root, "clock", o.use_sim_time ? o.clock : "", "rosgraph_msgs/msg/Clock",
                        o.use_sim_time ? Empty::kRefused : Empty::kAllowed);
  if (!o.use_sim_time && root.has("clock")) {
    root.problem("clock", "nothing reads it; expected use_sim_time: true, too");
  }
}

/// What people tell the robot by topics and services.
void read_people(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  o.acknowledge = topics.read(root, "acknowledge", "",
                              "std_msgs/msg/Bool, true acknowledges a stop", Empty::kAllowed);
  o.goal = topics.read(root, "goal", o.goal, "PoseStamped to go to", Empty::kAllowed);
  o.told = topics.read(root, "commands", o.told, "std_msgs/msg/String: hold, resume, cancel, stop",
                       Empty::kAllowed);
  o.services =
      topics.read(root, "services", o.services,
                  "before /hold, /resume, /cancel, /stop: std_srvs/srv/Trigger", Empty::kAllowed);
  o.action =
      topics.read(root, "action", o.action, "nav2_msgs/action/NavigateToPose", Empty::kAllowed);
}

std::string read_frame(YamlMap map, const std::string& key, const std::string& default_value,
                       const std::string& what) {
  std::string name = without_slash(map.text(key, default_value, what));
  if (name.empty()) map.problem(key, "it is empty; expected the name of a frame");
  return name;
}

/// Frames that are another thing by another name.
void check_frames(YamlMap frames, const DdsOptions& o) {
  const auto& f = o.frames;
  for (const auto& [key, name] : {std::pair("map", f.map), std::pair("odom", f.odom)}) {
    if (name != f.base || name.empty()) continue;
    frames.problem(frames.has(key) ? key : "base",
                   "'" + name + "' is frames." + key + " and frames.base; expected two frames");
  }
  if (f.map == f.odom && (o.output.transforms || o.output.odom_transform)) {
    frames.problem(frames.has("odom") ? "odom" : "map",
                   "'" + f.map +
                       "' is frames.map and frames.odom, between which a transform is "
                       "published (output); expected two frames");
  }
}

std::optional<double> limit(YamlMap map, const char* key, const char* unit, const char* what) {
  const double value = map.number(key, 0.0, 1e-3, 100.0, unit, what);
  if (map.has(key)) return value;
  return std::nullopt;
}

void read_odometry(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  o.odometry = topics.read(root, "odometry", o.odometry, "wheel motion",
                           o.is_told_its_pose() ? Empty::kAllowed : Empty::kRefused);
  const std::string type =
      root.choice("odometry_type", "Odometry",
                  {"Odometry", "TwistStamped", "TwistWithCovarianceStamped"}, "of the topic");
  o.odometry_type = (type == "Odometry" ? "nav_msgs/msg/" : "geometry_msgs/msg/") + type;
  o.odometry_by_tf = root.choice("odometry_frame", o.odometry_by_tf ? "tf" : "base", {"base", "tf"},
                                 "its frame: frames.base, or what tf fixes to it") == "tf";
  for (const char* key : {"odometry_type", "odometry_frame"}) {
    if (o.odometry.empty() && root.has(key)) {
      root.problem(key, "there is no odometry; expected its topic, too");
    }
  }
}

/// Who says where the robot is.
void read_pose(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Source = DdsOptions::PoseSource;
  YamlMap pose = root.map("pose");
  auto& p = o.pose;
  const std::string from =
      pose.choice("from", "stereo", {"stereo", "wheels", "tf", "topic"},
                  "who says where the robot is: its stereo pair, its odometry alone, tf, or the "
                  "topic of a localization");
  o.pose_source = from == "tf"       ? Source::kTf
                  : from == "topic"  ? Source::kTopic
                  : from == "wheels" ? Source::kWheels
                                     : Source::kStereo;
  p.topic = topics.read(pose, "topic", "", "poses in frames.map", TopicReader::Empty::kAllowed);
  const std::string package = "geometry_msgs/msg/";
  p.type = pose.choice("type", "PoseWithCovarianceStamped",
                       {"PoseWithCovarianceStamped", "PoseStamped", "Odometry"}, "of the topic");
  p.type = (p.type == "Odometry" ? "nav_msgs/msg/" : package) + p.type;
  p.frame = read_frame(pose, "frame", o.frames.base, "whose pose it is");
  p.sigma = pose.number("sigma", p.sigma, 0.0, 10.0, "m", "where no covariance is told");
  p.sigma_yaw = pose.number("sigma_yaw", p.sigma_yaw, 0.0, 3.0, "rad", "likewise");
  if ((from == "topic") == p.topic.empty()) {
    pose.problem(p.topic.empty() ? "from" : "topic",
                 p.topic.empty() ? "no topic tells it; expected pose.topic, too"
                                 : "from is " + from + "; expected pose.from: topic");
  }
  for (const char* key : {"type", "frame"}) {
    if (from != "topic" && pose.has(key)) {
      pose.problem(key, "from is " + from + "; expected pose.from: topic");
    }
  }
}

void read_stereo(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  YamlMap stereo = root.map("stereo");
  auto& s = o.stereo;
  s.left = topics.read(stereo, "left", s.left, "left images", Empty::kRefused);
  s.left_info = topics.read(stereo, "left_info", s.left_info, "calibration", Empty::kRefused);
  s.right = topics.read(stereo, "right", s.right, "right images", Empty::kAllowed);
  if (s.right.empty() && o.has_stereo()) {
    stereo.problem("right",
                   "it is none, and one camera measures no depth; expected its pair, or pose.from "
                   "with what measures ranges: depth.image, scan or point_cloud");
  }
  s.right_info = topics.read(stereo, "right_info", s.right_info, "calibration", Empty::kRefused);
  s.compressed = stereo.boolean("compressed", s.compressed, "images are CompressedImage");
  s.rectified = stereo.boolean("rectified", s.rectified, "images are rectified already");
  if (o.has_stereo()) return;
  if (stereo.present()) {
    root.problem("stereo",
                 "given, though pose.from says that it is not used; expected one of them");
  }
  s = {"", "", "", ""};
}

/// What its images are read by.
void read_images(YamlMap depth, DdsOptions::Depth& d) {
  d.compressed = depth.boolean("compressed", d.compressed, "images are compressedDepth, PNG");
  d.rectified = depth.boolean("rectified", is_named_rectified(d.image),
                              "images are rectified: those of a topic with rect in its name");
  d.per_metre = depth.number("per_metre", d.per_metre, 1.0, 1e5, "1/m",
                             "numbers a metre of images of 16 bits");
  d.min_range = depth.number("min_range", d.min_range, 0.0, 100.0, "m", "least depth that counts");
  d.max_range =
      depth.number("max_range", d.max_range, 0.1, 100.0, "m", "largest depth that counts");
  if (d.min_range >= d.max_range) {
    depth.problem("max_range", "not above min_range; expected 0 <= min_range < max_range");
  }
}

void read_depth(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  YamlMap depth = root.map("depth");
  auto& d = o.depth;
  // A robot without a stereo pair may see by a lidar alone.
  if (!o.has_stereo() && !(o.scan.empty() && o.point_cloud.empty())) d.image.clear();
  d.image = topics.read(depth, "image", d.image, "depth images", Empty::kAllowed);
  d.info = topics.read(depth, "info", d.image.empty() ? "" : d.info, "calibration",
                       d.image.empty() ? Empty::kAllowed : Empty::kRefused);
  read_images(depth, d);
}

/// Depth sensors besides the first.
void read_more_depth(YamlMap root, TopicReader& topics, DdsOptions& o) {
  using Empty = TopicReader::Empty;
  for (YamlMap map : root.maps("more_depth")) {
    DdsOptions::MoreDepth& more = o.more_depth.emplace_back();
    DdsOptions::Depth& d = more.depth;
    d.image = topics.read(map, "image", "", "depth images", Empty::kAllowed);
    if (!d.image.empty()) {
      d.info = topics.read(map, "info", "", "calibration", Empty::kRefused);
      read_images(map, d);
    }
    more.scan = topics.read(map, "scan", "", "LaserScan", Empty::kAllowed);
    more.point_cloud = topics.read(map, "point_cloud", "", "PointCloud2", Empty::kAllowed);
    if (!d.image.empty() + !more.scan.empty() + !more.point_cloud.empty() != 1) {
      map.problem("", "not one of image, scan and point_cloud; expected one of them");
    }
  }
  if (o.more_depth.size() >= static_cast<std::size_t>(kMostDepthSensors)) {
    root.problem("more_depth", std::to_string(o.more_depth.size()) + " sensors; expected up to " +
                                   std::to_string(kMostDepthSensors - 1));
  }
}

}  // namespace

DdsOptions read_dds_options(const std::string& path, const RosArguments& arguments) {
  using Empty = TopicReader::Empty;
  StrictYaml yaml = StrictYaml::from_file(path);
  NameRules rules(arguments.remap);
  for (const YamlSetting& setting : settings_of(arguments, rules)) yaml.set(setting);
  YamlMap root = yaml.root();
  DdsOptions o;
  o.address = read_address(root, arguments);
  TopicReader topics(rules, o.address);

  o.timeout =
      root.number("timeout", o.timeout, 0.1, 600.0, "s", "to wait for calibrations and transforms");

  read_clock(root, topics, o);
  o.tf = topics.read(root, "tf", o.tf, "TFMessage", Empty::kRefused);
  o.tf_static = topics.read(root, "tf_static", o.tf_static, "TFMessage", Empty::kRefused);

  YamlMap frames = root.map("frames");
  o.frames.map = read_frame(frames, "map", o.frames.map, "of the estimate and the map");
  o.frames.odom = read_frame(frames, "odom", o.frames.odom, "of the base's odometry");
  o.frames.base = read_frame(frames, "base", o.frames.base, "the body frame");

  read_pose(root, topics, o);
  read_stereo(root, topics, o);
  o.scan = topics.read(root, "scan", "", "LaserScan", Empty::kAllowed);
  o.point_cloud = topics.read(root, "point_cloud", "", "PointCloud2", Empty::kAllowed);
  read_depth(root, topics, o);
  read_more_depth(root, topics, o);
  if (!o.scan.empty() && !o.point_cloud.empty()) {
    root.problem("point_cloud", "given beside scan; expected one of them");
  }
  if (o.depth.image.empty() && o.scan.empty() && o.point_cloud.empty()) {
    root.problem("depth", "nothing measures ranges; expected depth.image, scan or point_cloud");
  }
  o.imu = topics.read(root, "imu", "", "sensor_msgs/msg/Imu", Empty::kAllowed);
  o.mounts_from_tf = root.choice("mounts", o.mounts_from_tf ? "tf" : "robot", {"robot", "tf"},
                                 "where cameras are: the robot's description, or tf") == "tf";
  read_odometry(root, topics, o);
  o.emergency_stop =
      topics.read(root, "emergency_stop", "", "std_msgs/msg/Bool, true stops", Empty::kAllowed);
  EmergencyStopContract& contract = o.emergency_stop_contract;
  contract.publishers =
      static_cast<int>(root.integer("emergency_stop_publishers", contract.publishers, 1, 100, "1",
                                    "that must be there, each with a word of its own"));
  contract.max_age =
      root.number("emergency_stop_age", contract.max_age, 0.05, 10.0, "s",
                  "of the newest word of each; latched: of its liveliness lease, at most");
  contract.latched = root.boolean("emergency_stop_latched", contract.latched,
                                  "it is published once, transient local, and when it changes");
  for (const char* key :
       {"emergency_stop_publishers", "emergency_stop_age", "emergency_stop_latched"}) {
    if (o.emergency_stop.empty() && root.has(key)) {
      root.problem(key, "there is no emergency_stop; expected its topic, too");
    }
  }

  read_people(root, topics, o);

  YamlMap command = root.map("command");
  auto& c = o.command;
  c.stamped = topics.read(command, "stamped", c.stamped, "TwistStamped", Empty::kAllowed);
  c.plain = topics.read(command, "plain", "", "Twist", Empty::kAllowed);
  if (c.stamped.empty() && c.plain.empty()) {
    command.problem("stamped", "no topic takes commands; expected stamped or plain");
  }
  c.dead_man = command.required_number("dead_man", 0.01, 10.0, "s",
                                       "silence after which the base's driver stops it by itself");
  c.relay = topics.read(command, "relay", "", "TwistStamped to a relay", Empty::kAllowed);
  c.relay_period = command.number("relay_period", c.relay_period, 0.005, 0.1, "s",
                                  "in which the relay looks, and repeats a stop");
  c.relay_age =
      command.choice("relay_age", o.use_sim_time ? "arrival" : "stamp", {"stamp", "arrival"},
                     "what the relay counts a command's age from") == "stamp"
          ? DdsOptions::RelayAge::kStamp
          : DdsOptions::RelayAge::kArrival;
  if (o.use_sim_time && c.relay_age == DdsOptions::RelayAge::kStamp) {
    command.problem("relay_age", "stamps are of a simulation (use_sim_time); expected arrival");
  }
  c.limits.speed = limit(command, "speed", "m/s", "that the base reaches");
  c.limits.yaw_rate = limit(command, "yaw_rate", "rad/s", "that the base reaches");
  c.limits.acceleration = limit(command, "acceleration", "m/s^2", "that the base reaches");
  c.limits.yaw_acceleration =
      limit(command, "yaw_acceleration", "rad/s^2", "that the base reaches");

  YamlMap output = root.map("output");
  auto& p = o.output;
  // Who localizes it tells map -> odom, and from a map of its own.
  // Of velocities alone nobody here knows where the driver's odom is.
  p.transforms = !o.is_told_its_pose() && o.tells_odometry_pose();
  if (o.is_told_its_pose()) p.map = "/prospect/map";
  p.path = topics.read(output, "path", p.path, "Path of the plan", Empty::kAllowed);
  p.map = topics.read(output, "map", p.map, "OccupancyGrid", Empty::kAllowed);
  p.octomap = topics.read(output, "octomap", p.octomap, "Octomap", Empty::kAllowed);
  p.markers = topics.read(output, "markers", p.markers, "target, plan, landmarks", Empty::kAllowed);
  p.diagnostics =
      topics.read(output, "diagnostics", p.diagnostics, "DiagnosticArray", Empty::kAllowed);
  p.state =
      topics.read(output, "state", p.state, "DiagnosticStatus of the drive mode", Empty::kAllowed);
  p.map_period = output.number("map_period", p.map_period, 0.1, 60.0, "s", "between two maps");
  p.transforms = output.boolean("transforms", p.transforms, "map -> odom on tf");
  p.odom_transform = output.boolean("odom_transform", p.odom_transform, "odom -> base on tf");
  for (const char* key : {"transforms", "odom_transform"}) {
    const bool told = std::string(key) == "transforms" ? p.transforms : p.odom_transform;
    if (told && o.pose_source == DdsOptions::PoseSource::kTf) {
      output.problem(key, "the pose comes from tf (pose.from); expected that others tell it");
    } else if (told && o.odometry.empty()) {
      output.problem(key, "there is no odometry; expected false");
    }
  }
  if (p.transforms && !o.odometry.empty() && !o.tells_odometry_pose() && !p.odom_transform) {
    output.problem("transforms",
                   "odometry tells no pose; expected output.odom_transform: true, too");
  }
  check_frames(frames, o);
  yaml.finish();
  if (const auto unused = rules.unused(); !unused.empty()) throw InputError(unused);
  return o;
}

}  // namespace prospect

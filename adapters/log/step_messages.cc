#include "adapters/log/step_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/files/input_error.h"
#include "adapters/files/parse_number.h"
#include "models/range_text.h"

namespace prospect {
namespace {

constexpr const char* kCandidates = "candidates";
constexpr const char* kFrontiers = "frontiers";
constexpr const char* kLandmarks = "landmarks";
constexpr const char* kTarget = "target";

// Entries of an Explanation: a cost weighted, then raw; a constraint raw only.
constexpr const char* kCost = "cost.";
constexpr const char* kRaw = "raw.";
constexpr const char* kConstraint = "constraint.";
// Of a cost, in this order: as asked for, in effect.
constexpr const char* kWeightAsked = "weight_asked.";
constexpr const char* kWeight = "weight.";

/// Told of each entry of a step that is a number or a word: its name, and the member.
template <class Step, class Visit>
void entries(Step& s, const Visit& visit) {
  visit("step", s.step);
  visit("time", s.time);
  visit("mode", s.mode);
  visit("cause", s.cause);
  visit("mode_since", s.mode_since);
  visit("caution", s.caution);
  visit("task", s.task);
  visit("plan_kind", s.plan_kind);
  visit("seed", s.seed);
  visit("command_v", s.command.linear.x());
  visit("command_vy", s.command.linear.y());
  visit("command_omega", s.command.yaw_rate);
  visit("estimated_x", s.estimated_pose.position.x());
  visit("estimated_y", s.estimated_pose.position.y());
  visit("estimated_z", s.estimated_pose.position.z());
  visit("estimated_yaw", s.estimated_pose.yaw);
  visit("true_x", s.true_pose.position.x());
  visit("true_y", s.true_pose.position.y());
  visit("true_z", s.true_pose.position.z());
  visit("true_yaw", s.true_pose.yaw);
  visit("localization", s.localization);
  visit("localization_error", s.localization_error);
  visit("predicted_features", s.predicted_features);
  visit("tracked_features", s.tracked_features);
  visit("coverage", s.coverage);
  visit("area", s.area);
  visit("path_length", s.path_length);
  visit("collisions", s.collisions);
  visit("clearance", s.clearance);
  visit("active_frontiers", s.active_frontiers);
  visit("target_change", s.target_change);
  visit("cost_evaluations", s.cost_evaluations);
  visit("gradient_evaluations", s.gradient_evaluations);
  visit("stop_reason", s.stop_reason);
  visit("quality", s.quality);
  visit("certified", s.certified);
  visit("certificate", s.certificate);
  visit("guard_stops", s.guard_stops);
  visit("guard_reason", s.guard_reason);
  visit("seeds_scored", s.seeds_scored);
  visit("features_weight", s.features_weight);
  visit("plan_ms", s.wall.plan);
  visit("frontiers_ms", s.wall.frontier_planner);
  visit("clearance_ms", s.wall.clearance);
  visit("views_ms", s.wall.views);
  visit("seeds_ms", s.wall.seeds);
  visit("polish_ms", s.wall.polish);
  visit("certify_ms", s.wall.certify);
}
template <class Target, class Visit>
void target_entries(Target& t, const Visit& visit) {
  visit("target_x", t.viewpoint.x());
  visit("target_y", t.viewpoint.y());
  visit("looks_x", t.looks_at.x());
  visit("looks_y", t.looks_at.y());
  visit("target_length", t.length);
  visit("target_area", t.area);
  visit("way_left", t.way_left);
}

/// Writes entries to a status.
struct WritesEntry {
  std::vector<ros::KeyValue>& to;
  void operator()(const char* name, const std::string& value) const { to.push_back({name, value}); }
  void operator()(const char* name, double value) const { to.push_back({name, exact_text(value)}); }
  void operator()(const char* name, int value) const {
    to.push_back({name, std::to_string(value)});
  }
  void operator()(const char* name, bool value) const { to.push_back({name, value ? "1" : "0"}); }
};

/// Reads the entries that are there.
struct ReadsEntry {
  const std::map<std::string, std::string>& from;
  const std::string& message;

  const std::string* find(const char* name) const {
    const auto found = from.find(name);
    return found == from.end() ? nullptr : &found->second;
  }
  void operator()(const char* name, std::string& value) const {
    if (const std::string* text = find(name)) value = *text;
  }
  template <typename Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  void operator()(const char* name, Number& value) const {
    const std::string* text = find(name);
    if (!text) return;
    double number = 0.0;
    if (!parse_number(*text, number)) {
      throw InputError(message + ": " + name + " is '" + *text + "'; expected a number");
    }
    if constexpr (std::is_floating_point_v<Number>) {
      value = number;
    } else {
      const double least = std::numeric_limits<int>::lowest(),
                   most = std::numeric_limits<int>::max();
      value = static_cast<Number>(std::isfinite(number) ? std::clamp(number, least, most) : 0.0);
    }
  }
};

void write_explanation(const Explanation& e, std::vector<ros::KeyValue>& to) {
  to.push_back({"cost", exact_text(e.cost)});
  to.push_back({"violation", exact_text(e.violation)});
  for (const TermValue& term : e.terms) {
    if (term.constraint) {
      to.push_back({kConstraint + term.name, exact_text(term.raw)});
      continue;
    }
    to.push_back({kCost + term.name, exact_text(term.weighted)});
    to.push_back({kRaw + term.name, exact_text(term.raw)});
  }
}

void write_weights(const std::vector<TermWeight>& weights, std::vector<ros::KeyValue>& to) {
  for (const TermWeight& weight : weights) {
    to.push_back({kWeightAsked + weight.name, exact_text(weight.asked)});
    to.push_back({kWeight + weight.name, exact_text(weight.in_effect)});
  }
}

/// The number of an entry.
double number_of(const ros::KeyValue& entry, const std::string& message) {
  double value = 0.0;
  if (parse_number(entry.value, value)) return value;
  throw InputError(message + ": " + entry.key + " is '" + entry.value + "'; expected a number");
}

std::vector<TermWeight> read_weights(const std::vector<ros::KeyValue>& from,
                                     const std::string& message) {
  std::vector<TermWeight> weights;
  for (const ros::KeyValue& entry : from) {
    if (entry.key.starts_with(kWeightAsked)) {
      weights.push_back(
          {entry.key.substr(std::strlen(kWeightAsked)), number_of(entry, message), 0.0});
    } else if (entry.key.starts_with(kWeight) && !weights.empty()) {
      weights.back().in_effect = number_of(entry, message);
    }
  }
  return weights;
}

Explanation read_explanation(const std::vector<ros::KeyValue>& from, const std::string& message) {
  Explanation e;
  for (const ros::KeyValue& entry : from) {
    const auto number = [&](double& value) { value = number_of(entry, message); };
    const auto begins = [&](const char* prefix) { return entry.key.rfind(prefix, 0) == 0; };
    const auto rest = [&](const char* prefix) { return entry.key.substr(std::strlen(prefix)); };
    if (entry.key == "cost") {
      number(e.cost);
    } else if (entry.key == "violation") {
      number(e.violation);
    } else if (begins(kCost)) {
      e.terms.push_back({rest(kCost), "", 0.0, 0.0, false});
      number(e.terms.back().weighted);
    } else if (begins(kRaw) && !e.terms.empty()) {
      number(e.terms.back().raw);
    } else if (begins(kConstraint)) {
      e.terms.push_back({rest(kConstraint), "", 0.0, 0.0, true});
      number(e.terms.back().raw);
    }
  }
  return e;
}

std::map<std::string, std::string> by_name(const std::vector<ros::KeyValue>& values) {
  std::map<std::string, std::string> entries;
  for (const ros::KeyValue& entry : values) entries[entry.key] = entry.value;
  return entries;
}

ros::Header header_at(std::int64_t ns) { return {stamp_at(ns), kMapFrame}; }

ros::Marker marker(const char* ns_name, int id, std::int32_t type, std::int64_t ns) {
  ros::Marker marker;
  marker.header = header_at(ns);
  marker.ns = ns_name;
  marker.id = id;
  marker.type = type;
  marker.action = ros::Marker::kAdd;
  return marker;
}

/// Of a cloud with its width: all else. `bytes`: the points, a float32 a field.
void finish_cloud(ros::PointCloud2& cloud, std::int64_t ns, const std::vector<std::string>& fields,
                  const std::string& bytes) {
  cloud.header = header_at(ns);
  cloud.height = 1;
  for (const std::string& name : fields) {
    cloud.point_fields.push_back({name, cloud.point_step, ros::PointField::kFloat32, 1});
    cloud.point_step += 4;
  }
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  cloud.is_dense = true;
}

void set_scale(ros::Marker& marker, double size) { marker.scale = {size, size, size}; }

}  // namespace

ros::Time stamp_at(std::int64_t ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t from = std::max<std::int64_t>(0, ns);
  return {static_cast<std::int32_t>(from / kSecond), static_cast<std::uint32_t>(from % kSecond)};
}

ros::DiagnosticArray step_values(const StepRecord& s, std::int64_t ns) {
  ros::DiagnosticArray array;
  array.header = header_at(ns);
  ros::DiagnosticStatus status;
  status.level = s.localization == "lost" ? ros::DiagnosticStatus::kError
                 : s.guard_stops > 0 || !s.certified || s.localization != "ok"
                     ? ros::DiagnosticStatus::kWarn
                     : ros::DiagnosticStatus::kOk;
  status.name = "planning step";
  status.message = s.why;
  status.hardware_id = "prospect";
  const WritesEntry write{status.values};
  entries(s, write);
  if (s.goal) {
    write("goal_x", s.goal->x());
    write("goal_y", s.goal->y());
  }
  if (s.goal_yaw) write("goal_yaw", *s.goal_yaw);
  if (s.target) target_entries(*s.target, write);
  write_explanation(s.explanation, status.values);
  write_weights(s.weights, status.values);
  array.status.push_back(std::move(status));
  for (const CandidateRecord& c : s.candidates) {
    ros::DiagnosticStatus candidate;
    candidate.name = c.name;
    candidate.message = c.verdict;
    candidate.hardware_id = "prospect";
    candidate.values.push_back({"polished", c.polished ? "1" : "0"});
    write_explanation(c.explanation, candidate.values);
    array.status.push_back(std::move(candidate));
  }
  return array;
}

void read_step_values(const ros::DiagnosticArray& array, const std::string& name, StepRecord& s) {
  if (array.status.empty()) return;
  const ros::DiagnosticStatus& status = array.status.front();
  const std::map<std::string, std::string> values = by_name(status.values);
  const ReadsEntry read{values, name};
  s.why = status.message;
  entries(s, read);
  if (values.count("goal_x")) {
    s.goal = Eigen::Vector2d::Zero();
    read("goal_x", s.goal->x());
    read("goal_y", s.goal->y());
  }
  if (values.count("goal_yaw")) {
    s.goal_yaw = 0.0;
    read("goal_yaw", *s.goal_yaw);
  }
  if (values.count("target_x")) {
    s.target.emplace();
    target_entries(*s.target, read);
  }
  s.explanation = read_explanation(status.values, name);
  s.weights = read_weights(status.values, name);
  for (std::size_t i = 1; i < array.status.size(); ++i) {
    const ros::DiagnosticStatus& from = array.status[i];
    const std::map<std::string, std::string> entries_of = by_name(from.values);
    CandidateRecord candidate;
    candidate.name = from.name;
    candidate.verdict = from.message;
    ReadsEntry{entries_of, name}("polished", candidate.polished);
    candidate.explanation = read_explanation(from.values, name);
    s.candidates.push_back(std::move(candidate));
  }
}

ros::Path horizon_path(const StepRecord& step, double dt, std::int64_t ns) {
  ros::Path path;
  path.header = header_at(ns);
  for (std::size_t k = 0; k < step.horizon.size(); ++k) {
    const Pose& p = step.horizon[k];
    ros::PoseStamped pose;
    pose.header = header_at(ns + std::llround(1e9 * dt * static_cast<double>(k)));
    pose.pose.position = {p.position.x(), p.position.y(), p.position.z()};
    pose.pose.orientation = {0.0, 0.0, std::sin(0.5 * p.yaw), std::cos(0.5 * p.yaw)};
    path.poses.push_back(std::move(pose));
  }
  return path;
}

void read_horizon_path(const ros::Path& path, StepRecord& step) {
  step.horizon.clear();
  for (const ros::PoseStamped& p : path.poses) {
    const ros::Point& at = p.pose.position;
    const ros::Quaternion& q = p.pose.orientation;
    step.horizon.push_back({{at.x, at.y, at.z}, 2.0 * std::atan2(q.z, q.w)});
  }
}

ros::MarkerArray step_markers(const StepRecord& step, double resolution, std::int64_t ns) {
  ros::MarkerArray array;
  ros::Marker all = marker("", 0, 0, ns);
  all.action = ros::Marker::kDeleteAll;
  array.markers.push_back(std::move(all));
  if (step.target) {
    ros::Marker target = marker(kTarget, 0, ros::Marker::kArrow, ns);
    target.scale = {0.05, 0.12, 0.15};  // shaft, head, length of the head [m]
    target.color = {0.9F, 0.5F, 0.0F, 1.0F};
    target.points = {{step.target->viewpoint.x(), step.target->viewpoint.y(), 0.0},
                     {step.target->looks_at.x(), step.target->looks_at.y(), 0.0}};
    array.markers.push_back(std::move(target));
  }
  ros::Marker frontiers = marker(kFrontiers, 0, ros::Marker::kCubeList, ns);
  set_scale(frontiers, resolution);
  frontiers.color = {0.1F, 0.5F, 1.0F, 0.8F};
  for (const Eigen::Vector2f& p : step.frontier_cells)
    frontiers.points.push_back({p.x(), p.y(), 0.0});
  array.markers.push_back(std::move(frontiers));
  ros::Marker landmarks = marker(kLandmarks, 0, ros::Marker::kPoints, ns);
  set_scale(landmarks, 0.05);
  landmarks.color = {0.0F, 0.0F, 0.0F, 1.0F};
  for (const LandmarkView& l : step.landmarks) {
    landmarks.points.push_back({l.x, l.y, 0.0});
    landmarks.colors.push_back({1.0F - l.visibility, l.visibility, 0.0F, 1.0F});
  }
  array.markers.push_back(std::move(landmarks));
  for (std::size_t i = step.candidates.size(); i-- > 0;) {
    const CandidateRecord& c = step.candidates[i];
    ros::Marker way = marker(kCandidates, static_cast<int>(i), ros::Marker::kLineStrip, ns);
    const bool executed = c.verdict == "executed";
    set_scale(way, executed ? 0.04 : 0.02);
    way.color =
        executed ? ros::ColorRGBA{0.1F, 0.7F, 0.2F, 1.0F} : ros::ColorRGBA{0.5F, 0.5F, 0.5F, 0.6F};
    way.text = c.name + ": " + c.verdict;
    for (const Eigen::Vector2f& p : c.path) way.points.push_back({p.x(), p.y(), 0.0});
    array.markers.push_back(std::move(way));
  }
  return array;
}

void read_step_markers(const ros::MarkerArray& array, StepRecord& step) {
  const auto point = [](const ros::Point& p) {
    return Eigen::Vector2f(static_cast<float>(p.x), static_cast<float>(p.y));
  };
  for (const ros::Marker& m : array.markers) {
    if (m.action != ros::Marker::kAdd) continue;
    if (m.ns == kFrontiers) {
      step.frontier_cells.clear();
      for (const ros::Point& p : m.points) step.frontier_cells.push_back(point(p));
    } else if (m.ns == kLandmarks) {
      step.landmarks.clear();
      for (std::size_t i = 0; i < m.points.size() && i < m.colors.size(); ++i) {
        const Eigen::Vector2f p = point(m.points[i]);
        step.landmarks.push_back({p.x(), p.y(), m.colors[i].g});
      }
    } else if (m.ns == kCandidates && m.id >= 0 &&
               static_cast<std::size_t>(m.id) < step.candidates.size()) {
      std::vector<Eigen::Vector2f>& path = step.candidates[static_cast<std::size_t>(m.id)].path;
      path.clear();
      for (const ros::Point& p : m.points) path.push_back(point(p));
    }
  }
}

ros::PointCloud2 cost_to_go_points(const CostToGoPicture& picture, std::int64_t ns,
                                   std::string& bytes) {
  bytes.clear();
  ros::PointCloud2 cloud;
  for (int k = 0; k < picture.frame.size(); ++k) {
    const float seconds = picture.seconds[static_cast<std::size_t>(k)];
    if (!std::isfinite(seconds)) continue;
    const Eigen::Vector2d p = picture.frame.center(picture.frame.at(k));
    const float point[] = {static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F, seconds};
    bytes.append(reinterpret_cast<const char*>(point), sizeof point);
    ++cloud.width;
  }
  finish_cloud(cloud, ns, {"x", "y", "z", "seconds"}, bytes);
  return cloud;
}

CostToGoPicture read_cost_to_go_points(const ros::PointCloud2& cloud, double resolution) {
  struct Point {
    Cell cell;
    float seconds;
  };
  std::vector<Point> points;
  CostToGoPicture picture;
  GridFrame& frame = picture.frame;
  frame = {resolution, 0, 0, 0, 0};
  constexpr std::size_t kSize = 16;
  if (cloud.point_step != kSize || cloud.is_bigendian) return picture;
  Cell low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()},
      high{std::numeric_limits<int>::lowest(), std::numeric_limits<int>::lowest()};
  for (std::size_t at = 0; at + kSize <= cloud.data.size(); at += kSize) {
    float p[4];
    std::memcpy(p, cloud.data.data() + at, sizeof p);
    if (!(std::abs(p[0]) < 1e5F && std::abs(p[1]) < 1e5F)) continue;
    const Cell cell = frame.cell(p[0], p[1]);
    low = {std::min(low.i, cell.i), std::min(low.j, cell.j)};
    high = {std::max(high.i, cell.i), std::max(high.j, cell.j)};
    points.push_back({cell, p[3]});
  }
  if (points.empty()) return picture;
  const double cells = (double{1} + high.i - low.i) * (double{1} + high.j - low.j);
  if (cells > 1e7) return picture;  // of no map that was planned on
  frame = {resolution, low.i, low.j, high.i - low.i + 1, high.j - low.j + 1};
  picture.seconds.assign(static_cast<std::size_t>(frame.size()),
                         std::numeric_limits<float>::quiet_NaN());
  for (const Point& p : points) {
    picture.seconds[static_cast<std::size_t>(frame.index(p.cell))] = p.seconds;
  }
  return picture;
}

ros::PointCloud2 picture_features(const LandmarkPicture& picture, std::int64_t ns,
                                  std::string& bytes) {
  bytes.clear();
  ros::PointCloud2 cloud;
  for (const LandmarkPicture::Feature& f : picture.features) {
    const float point[] = {f.u, f.v, static_cast<float>(f.kind)};
    bytes.append(reinterpret_cast<const char*>(point), sizeof point);
    ++cloud.width;
  }
  finish_cloud(cloud, ns, {"u", "v", "kind"}, bytes);
  return cloud;
}

std::vector<LandmarkPicture::Feature> read_picture_features(const ros::PointCloud2& cloud) {
  std::vector<LandmarkPicture::Feature> features;
  constexpr std::size_t kSize = 12;
  if (cloud.point_step != kSize || cloud.is_bigendian) return features;
  for (std::size_t at = 0; at + kSize <= cloud.data.size(); at += kSize) {
    float p[3];
    std::memcpy(p, cloud.data.data() + at, sizeof p);
    const bool known = p[2] == 0.0F || p[2] == 1.0F || p[2] == 2.0F;
    if (known) features.push_back({p[0], p[1], static_cast<int>(p[2])});
  }
  return features;
}

}  // namespace prospect

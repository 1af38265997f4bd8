// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/step_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/missions/run/step_fields.h"
#include "models/formatted.h"
#include "models/range_text.h"

namespace prospect {
namespace {

constexpr const char* kCandidates = "candidates";
constexpr const char* kFrontiers = "frontiers";
constexpr const char* kLandmarks = "landmarks";
constexpr const char* kTarget = "target";

using Why = FrontierStanding::Why;
constexpr Why kFrontierWhys[] = {Why::kInOrder, Why::kLater,   Why::kLowYield,
                                 Why::kLittle,  Why::kFarther, Why::kNoPath};

// Entries of an Explanation: a cost weighted, then raw; a constraint raw only.
constexpr const char* kCost = "cost.";
constexpr const char* kRaw = "raw.";
constexpr const char* kConstraint = "constraint.";
constexpr const char* kPolished = "polished";  // of a candidate

/// The fields that have an entry, in the order of their places.
const std::vector<const StepField*>& entry_fields() {
  static const std::vector<const StepField*> entries = [] {
    std::vector<const StepField*> list;
    for (const StepField& field : step_fields()) {
      if (field.log_place > 0) list.push_back(&field);
    }
    std::sort(list.begin(), list.end(),
              [](const StepField* a, const StepField* b) { return a->log_place < b->log_place; });
    return list;
  }();
  return entries;
}

/// "weight." of what there is of each weight.
std::string entry_prefix(const StepField& field) { return std::string(field.name) + '.'; }

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

void write_weights(const StepRecord& step, std::vector<ros::KeyValue>& to) {
  for (const TermWeight& weight : step.weights) {
    for (const StepField& field : step_fields()) {
      if (field.per != FieldPer::kWeight) continue;
      to.push_back({entry_prefix(field) + weight.name, text_of(field.of(step, weight.name))});
    }
  }
}

void read_weights(const std::vector<ros::KeyValue>& from, const std::string& message,
                  StepRecord& step) {
  for (const ros::KeyValue& entry : from) {
    for (const StepField& field : step_fields()) {
      if (field.per != FieldPer::kWeight || !entry.key.starts_with(entry_prefix(field))) continue;
      enter_field(field, entry.key.substr(entry_prefix(field).size()), entry.value, message, step);
    }
  }
}

/// The number of an entry.
double number_of(const ros::KeyValue& entry, const std::string& message) {
  double value = 0.0;
  if (parse_number(entry.value, value)) return value;
  throw InputError(message + ": " + entry.key + " is '" + entry.value + "'; expected a number");
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
  status.level = s.localization == Localization::kLost ? ros::DiagnosticStatus::kError
                 : s.guard_stops > 0 || !s.certified || s.localization != Localization::kOk
                     ? ros::DiagnosticStatus::kWarn
                     : ros::DiagnosticStatus::kOk;
  status.name = "planning step";
  status.message = s.why;
  status.hardware_id = "prospect";
  for (const StepField* field : entry_fields()) {
    const StepValue value = field->of(s, "");
    if (std::holds_alternative<std::monostate>(value)) continue;
    status.values.push_back({std::string(field->name), text_of(value)});
  }
  write_explanation(s.explanation, status.values);
  write_weights(s, status.values);
  array.status.push_back(std::move(status));
  for (const CandidateRecord& c : s.candidates) {
    ros::DiagnosticStatus candidate;
    candidate.name = c.name;
    candidate.message = to_string(c.verdict);
    candidate.hardware_id = "prospect";
    candidate.values.push_back({kPolished, c.polished ? "1" : "0"});
    write_explanation(c.explanation, candidate.values);
    array.status.push_back(std::move(candidate));
  }
  return array;
}

void read_step_values(const ros::DiagnosticArray& array, const std::string& name, StepRecord& s) {
  if (array.status.empty()) return;
  const ros::DiagnosticStatus& status = array.status.front();
  const std::map<std::string, std::string> values = by_name(status.values);
  s.why = status.message;
  for (const StepField* field : entry_fields()) {
    const auto entry = values.find(std::string(field->name));
    if (entry != values.end()) enter_field(*field, "", entry->second, name, s);
  }
  s.explanation = read_explanation(status.values, name);
  read_weights(status.values, name, s);
  for (std::size_t i = 1; i < array.status.size(); ++i) {
    const ros::DiagnosticStatus& from = array.status[i];
    CandidateRecord candidate;
    candidate.name = from.name;
    candidate.verdict = verdict_named(from.message);
    for (const ros::KeyValue& entry : from.values) {
      if (entry.key == kPolished) candidate.polished = number_of(entry, name) != 0.0;
    }
    candidate.explanation = read_explanation(from.values, name);
    s.candidates.push_back(std::move(candidate));
  }
}

ros::Path horizon_path(const StepRecord& step, double dt, std::int64_t ns) {
  ros::Path path;
  path.header = header_at(ns);
  for (std::size_t k = 0; k < step.horizon.size(); ++k) {
    ros::PoseStamped pose;
    pose.header = header_at(ns + std::llround(1e9 * dt * static_cast<double>(k)));
    pose.pose = ros::pose_message(step.horizon[k]);
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
    const bool executed = c.verdict.kind == Verdict::Kind::kExecuted;
    set_scale(way, executed ? 0.04 : 0.02);
    way.color =
        executed ? ros::ColorRGBA{0.1F, 0.7F, 0.2F, 1.0F} : ros::ColorRGBA{0.5F, 0.5F, 0.5F, 0.6F};
    way.text = c.name + ": " + to_string(c.verdict);
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

ros::MarkerArray frontier_markers(const StepRecord& step, std::int64_t ns) {
  ros::MarkerArray array;
  ros::Marker all = marker("", 0, 0, ns);
  all.action = ros::Marker::kDeleteAll;
  array.markers.push_back(std::move(all));
  for (std::size_t i = 0; i < step.standings.size(); ++i) {
    const FrontierRecord& f = step.standings[i];
    const std::string why(name(f.why));
    ros::Marker label = marker(why.c_str(), static_cast<int>(i), ros::Marker::kText, ns);
    label.pose.position = {f.place.x(), f.place.y(), 0.0};
    label.scale = {0.0, 0.0, 0.2};  // height of a letter [m]
    const bool next = f.why == Why::kInOrder;
    label.color =
        next ? ros::ColorRGBA{0.9F, 0.5F, 0.0F, 1.0F} : ros::ColorRGBA{0.4F, 0.4F, 0.4F, 1.0F};
    label.text = (next ? std::to_string(i + 1) : why) + formatted(": %.2f m2", f.area);
    if (std::isfinite(f.time)) label.text += formatted(" in %.1f s", f.time);
    label.points = {{f.area, f.unknown, f.time}};
    array.markers.push_back(std::move(label));
  }
  return array;
}

void read_frontier_markers(const ros::MarkerArray& array, StepRecord& step) {
  step.standings.clear();
  for (const ros::Marker& m : array.markers) {
    if (m.action != ros::Marker::kAdd || m.points.size() != 1) continue;
    const auto why = std::find_if(std::begin(kFrontierWhys), std::end(kFrontierWhys),
                                  [&](Why w) { return m.ns == name(w); });
    if (why == std::end(kFrontierWhys)) continue;
    const ros::Point& at = m.pose.position;
    step.standings.push_back(
        {Eigen::Vector2d(at.x, at.y), *why, m.points[0].x, m.points[0].y, m.points[0].z});
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

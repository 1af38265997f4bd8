// SPDX-License-Identifier: Apache-2.0
#include "engine/task/zone_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;  // [m]
constexpr double kGiven = 1e-5;     // [m] of a reduced margin, so that rounding keeps nobody there

}  // namespace

ZoneMap::Region ZoneMap::region(const Polygon& polygon) {
  Region r{polygon, polygon.front(), polygon.front()};
  for (const Eigen::Vector2d& p : polygon) {
    r.low = r.low.cwiseMin(p);
    r.high = r.high.cwiseMax(p);
  }
  return r;
}

double ZoneMap::Region::distance(const Eigen::Vector2d& p, double most) const {
  if (!inside_out) {
    const double out = (low - p).cwiseMax(p - high).cwiseMax(0.0).norm();
    if (out >= most && out > 0.0) return out;
  }
  const double d = signed_distance(polygon, p);
  return inside_out ? -d : d;
}

ZoneMap::ZoneMap(Zones zones) : zones_(std::move(zones)) {
  const std::vector<std::string> wrong = faults(zones_);
  if (!wrong.empty()) throw std::invalid_argument("zones: " + wrong.front());
  if (zones_.bound) {
    parts_.push_back(region(*zones_.bound));
    parts_.back().inside_out = true;
  }
  for (const Polygon& polygon : zones_.keep_out) parts_.push_back(region(polygon));
  for (const SpeedZone& zone : zones_.slow) {
    slow_.push_back(region(zone.area));
    slow_.back().speed = zone.max_speed;
  }
}

std::string ZoneMap::name(int part) const {
  const int keep_out = part - (zones_.bound ? 1 : 0);
  return keep_out < 0 ? "zones.bound" : "zones.keep_out[" + std::to_string(keep_out) + "]";
}

int ZoneMap::corners(int part) const {
  return static_cast<int>(parts_[static_cast<std::size_t>(part)].polygon.size());
}

std::pair<Eigen::Vector2d, Eigen::Vector2d> ZoneMap::forbidden_box() const {
  std::pair box(parts_.front().low, parts_.front().high);
  for (const Region& part : parts_) {
    box.first = box.first.cwiseMin(part.low);
    box.second = box.second.cwiseMax(part.high);
  }
  return box;
}

double ZoneMap::distance(int part, const Eigen::Vector2d& p) const {
  return parts_[static_cast<std::size_t>(part)].distance(p, kInfinity);
}

double ZoneMap::distance(const Eigen::Vector2d& p) const {
  double least = kInfinity;
  for (const Region& part : parts_) least = std::min(least, part.distance(p, least));
  return least;
}

double ZoneMap::gap(int part, const BodyOutline& body, const Pose& pose) const {
  const Region& region = parts_[static_cast<std::size_t>(part)];
  const Polygon& polygon = region.polygon;
  const Eigen::Rotation2Dd R(pose.yaw);
  const Eigen::Vector2d origin = pose.position.head<2>();
  double least = kInfinity;
  for (const Disc& disc : body.discs) {
    least = std::min(least, region.distance(origin + R * disc.center, kInfinity) - disc.radius);
  }
  if (body.corners.empty()) return least;
  std::vector<Eigen::Vector2d> corners;
  corners.reserve(body.corners.size());
  for (const Eigen::Vector2d& c : body.corners) corners.push_back(origin + R * c);
  // Apart if the sides are and neither holds a corner of the other.
  double sides = kInfinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    for (std::size_t j = 0; j < polygon.size(); ++j) {
      sides =
          std::min(sides, segment_distance(a, b, polygon[j], polygon[(j + 1) % polygon.size()]));
    }
  }
  const bool within = contains(polygon, corners.front());
  const bool overlap =
      sides == 0.0 || (region.inside_out ? !within : within || contains(corners, polygon.front()));
  return std::min(least, overlap ? -std::max(sides, kRounding) : sides);
}

double ZoneMap::speed_limit(const Eigen::Vector2d& p, double within) const {
  double limit = kInfinity;
  for (const Region& zone : slow_) {
    if (zone.speed < limit && zone.distance(p, within + kRounding) <= within) limit = zone.speed;
  }
  return limit;
}

double ZoneMap::approach_speed(const Eigen::Vector2d& p, double deceleration, double early) const {
  double squared = kInfinity;
  for (const Region& zone : slow_) {
    const double s = std::max(0.0, zone.distance(p, kInfinity) - early);
    squared = std::min(squared, zone.speed * zone.speed + 2.0 * deceleration * s);
  }
  return std::sqrt(squared);
}

std::shared_ptr<const ZoneMap> zone_map_of(const Zones& zones) {
  return zones.empty() ? nullptr : std::make_shared<const ZoneMap>(zones);
}

ZoneWalk::ZoneWalk(const ZoneMap& zones, const BodyOutline& body, const Pose& start, double margin,
                   double reduced_margin_share)
    : zones_(zones),
      body_(body),
      kept_(static_cast<std::size_t>(zones.num_forbidden())),
      margin_(margin) {
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    Kept& kept = kept_[k];
    const double gap = zones.gap(static_cast<int>(k), body, start);
    kept.inside = gap < 0.0;
    kept.depth = zones.distance(static_cast<int>(k), start.position.head<2>());
    kept.gap = gap >= margin ? margin : std::max(0.0, reduced_margin_share * gap - kGiven);
    margin_ = std::min(margin_, kept.gap);
  }
}

int ZoneWalk::step(const Pose& pose) {
  int entered = -1;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    Kept& kept = kept_[k];
    const int part = static_cast<int>(k);
    const double gap = zones_.gap(part, body_, pose);
    if (kept.inside) {
      if (gap >= 0.0) {
        kept.inside = false;
      } else {
        const double depth = zones_.distance(part, pose.position.head<2>());
        if (depth < kept.depth - kRounding && entered < 0) entered = part;
        kept.depth = depth;
      }
    } else if (gap < kept.gap - kRounding && entered < 0) {
      entered = part;
    }
  }
  return entered;
}

}  // namespace prospect

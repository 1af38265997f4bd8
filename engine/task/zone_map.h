// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/task/body_outline.h"
#include "engine/task/zones.h"
#include "models/types.h"

namespace prospect {

/// The geometry of Zones. The forbidden parts, numbered: the bound's outside first, if there is a
/// bound, then each keep-out polygon.
///
/// Thread-safety: immutable; concurrent calls are safe. Nothing throws after construction.
class ZoneMap {
 public:
  /// Throws std::invalid_argument with the first of faults(zones).
  explicit ZoneMap(Zones zones);

  const Zones& zones() const { return zones_; }
  int num_forbidden() const { return static_cast<int>(parts_.size()); }
  bool slows() const { return !slow_.empty(); }
  /// Its key: "zones.bound", "zones.keep_out[1]".
  std::string name(int part) const;
  /// Corners of that part.
  int corners(int part) const;
  /// Lowest and highest corner of the box about the corners of all forbidden parts [m]; there must
  /// be some.
  std::pair<Eigen::Vector2d, Eigen::Vector2d> forbidden_box() const;

  /// Signed distance from p to a forbidden part, or to the nearest of all [m]: negative in it;
  /// +infinity if there is none. Exact outside of all.
  double distance(int part, const Eigen::Vector2d& p) const;
  double distance(const Eigen::Vector2d& p) const;

  /// Distance from a body at a pose to a forbidden part [m]; negative where they overlap (how much
  /// it is says nothing then). Exact.
  double gap(int part, const BodyOutline& body, const Pose& pose) const;

  /// The least speed allowed within `within` [m] of p [m/s]; +infinity away from all slow zones.
  double speed_limit(const Eigen::Vector2d& p, double within = 0.0) const;
  /// The speed at p from which a robot that brakes with `deceleration` [m/s^2], > 0, still enters
  /// each zone no faster than it may: min over zones of sqrt(limit^2 + 2 deceleration s), s the
  /// distance to the zone less `early` [m], at least 0.
  double approach_speed(const Eigen::Vector2d& p, double deceleration, double early) const;

 private:
  /// A polygon, and the box that bounds it.
  struct Region {
    Polygon polygon;
    Eigen::Vector2d low, high;
    bool inside_out = false;  // the outside counts
    double speed = 0.0;       // of a slow zone
    /// Signed distance where it is below `most`, else anything that is not below it.
    double distance(const Eigen::Vector2d& p, double most) const;
  };
  static Region region(const Polygon& polygon);

  Zones zones_;
  std::vector<Region> parts_;
  std::vector<Region> slow_;
};

/// The geometry of zones to share; null if there are none. Throws as ZoneMap does.
std::shared_ptr<const ZoneMap> zone_map_of(const Zones& zones);

/// What a motion does about the forbidden parts, pose by pose; the rule is that of the Certifier
/// for obstacles:
///   a body that starts at least `margin` away from a part keeps `margin`;
///   one that starts nearer keeps `reduced_margin_share` times its distance (0 to 1; less 0.01 mm);
///   one that starts in it may not take its origin deeper, and once it is out it stays out.
class ZoneWalk {
 public:
  /// zones and body outlive the walk.
  ZoneWalk(const ZoneMap& zones, const BodyOutline& body, const Pose& start, double margin,
           double reduced_margin_share);

  /// The part that the body enters at `pose`, the motion's next one; -1: none.
  int step(const Pose& pose);
  /// The least distance that is kept of any part [m].
  double margin() const { return margin_; }

 private:
  struct Kept {
    double gap = 0.0;     // to be kept
    bool inside = false;  // the body is in it since the start
    double depth = 0.0;   // signed distance of the origin there
  };
  const ZoneMap& zones_;
  const BodyOutline& body_;
  std::vector<Kept> kept_;
  double margin_;
};

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "runtime/range_stop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/robot_description.h"
#include "models/unicycle.h"

namespace prospect::range_stop_test {
namespace {

using ::testing::HasSubstr;
using Kind = RangeRay::Kind;

constexpr double kRange = 4.0;  // [m] of the sensor
constexpr double kDegree = M_PI / 180.0;

/// Where a ray from `origin` at azimuth `a` meets the line x = wall, in (x, y); infinite: nowhere.
double to_wall(const Eigen::Vector2d& origin, double a, double wall) {
  const double t = (wall - origin.x()) / std::cos(a);
  return t > 0.0 && std::isfinite(t) ? t : std::numeric_limits<double>::infinity();
}

/// A scan at height 0.3 m of a wall across the way at x = wall, with rays every degree.
RangeFrame scan_of_wall(double wall, double field = 270.0, double stamp = 10.0) {
  RangeFrame frame;
  frame.stamp = stamp;
  frame.origin = {0.0, 0.0, 0.3};
  for (double degrees = -0.5 * field; degrees <= 0.5 * field; degrees += 1.0) {
    const double a = degrees * kDegree;
    const double range = to_wall(frame.origin.head<2>(), a, wall);
    const double shown = std::min(range, kRange);
    frame.rays.push_back({frame.origin + shown * Eigen::Vector3d(std::cos(a), std::sin(a), 0.0),
                          range < kRange ? Kind::kHit : Kind::kClear});
  }
  return frame;
}

RangeFrame with_points(RangeFrame frame, const std::vector<Eigen::Vector3d>& points) {
  for (const Eigen::Vector3d& p : points) frame.rays.push_back({p, Kind::kHit});
  return frame;
}

std::vector<Eigen::Vector3d> three(double x, double y, double z = 0.3) {
  return {{x, y, z}, {x, y, z}, {x, y, z}};
}

/// Every `n`th ray stays valid.
RangeFrame thinned(RangeFrame frame, std::size_t n) {
  for (std::size_t k = 0; k < frame.rays.size(); ++k) {
    if (k % n != 0) frame.rays[k].kind = Kind::kInvalid;
  }
  return frame;
}

/// Every `n`th ray is there.
RangeFrame every(const RangeFrame& frame, std::size_t n) {
  RangeFrame coarse = frame;
  coarse.rays.clear();
  for (std::size_t k = 0; k < frame.rays.size(); k += n) coarse.rays.push_back(frame.rays[k]);
  return coarse;
}

Twist twist(double v, double w = 0.0, double vy = 0.0) { return {{v, vy, 0.0}, w}; }

const RangeFrame kOpen = scan_of_wall(100.0, 360.0);

TEST(RangeStop, TableOfChecks) {
  using R = RangeStopReason;
  struct Case {
    const char* what;
    RangeFrame frame;
    Twist command;
    R reason;
    double least, most;  // share
  };
  RangeFrame covered = scan_of_wall(100.0, 70.0);
  for (RangeRay& ray : covered.rays) ray.kind = Kind::kInvalid;
  RangeFrame unmeasured = with_points(kOpen, three(0.4, 0.0));
  for (std::size_t k = 0; k < 3; ++k)
    unmeasured.rays[unmeasured.rays.size() - 1 - k].kind = Kind::kInvalid;
  // Rays from above the body's height, by how much they fall in a metre. Ahead they are met at 0.6
  // m.
  const auto rays_that_fall = [](double height, double slope) {
    RangeFrame frame = scan_of_wall(100.0, 120.0);
    frame.origin.z() = height;
    for (RangeRay& ray : frame.rays) {
      ray.point.z() = height - slope * (ray.point - frame.origin).head<2>().norm();
    }
    return frame;
  };
  RangeFrame floor_alone = covered;
  for (const RangeRay& ray : rays_that_fall(0.3, 0.75).rays) floor_alone.rays.push_back(ray);
  const RangeFrame falling = rays_that_fall(0.5, 0.32);
  RangeFrame nowhere = kOpen;
  for (RangeRay& ray : nowhere.rays) ray.point.x() = std::nan("");
  const RangeFrame narrow = scan_of_wall(100.0, 70.0);
  RangeFrame without_rays;
  without_rays.stamp = 10.0;
  // At 0.5 m/s: 0.1 s age, 0.15 s reaction, 0.5 s half of the stop: 0.375 m; body 0.25, margin
  // 0.05.
  for (const Case& c : {
           Case{"nothing around", kOpen, twist(0.5), R::kClear, 1, 1},
           Case{"a wall farther than the stop", scan_of_wall(0.69), twist(0.5), R::kClear, 1, 1},
           Case{"a wall a little nearer", scan_of_wall(0.65), twist(0.5), R::kObstacle, 0.9, 0.99},
           Case{"a wall half as far", scan_of_wall(0.5), twist(0.5), R::kObstacle, 0.4, 0.65},
           Case{"a wall before it", scan_of_wall(0.31), twist(0.5), R::kObstacle, 0, 0},
           Case{"the same, away from it", scan_of_wall(0.31, 360.0), twist(-0.5), R::kClear, 1, 1},
           Case{"the same, on the spot", scan_of_wall(0.31), twist(0.0, 1.0), R::kClear, 1, 1},
           Case{"standing", scan_of_wall(0.26), twist(0.0), R::kClear, 1, 1},
           Case{"standing, blind", without_rays, twist(0.0), R::kClear, 1, 1},
           Case{"a post", with_points(kOpen, three(0.5, 0.1)), twist(0.5), R::kObstacle, 0.3, 0.7},
           Case{"a post beside the way", with_points(kOpen, three(0.5, 0.31)), twist(0.5),
                R::kClear, 1, 1},
           Case{"the same on an arc", with_points(kOpen, three(0.5, 0.31)), twist(0.5, 0.8),
                R::kObstacle, 0.2, 0.9},
           Case{"sideways", with_points(kOpen, three(0.0, 0.5)), twist(0.0, 0.0, 0.5), R::kObstacle,
                0.3, 0.7},
           Case{"two points are noise", with_points(kOpen, {{0.4, 0, 0.3}, {0.4, 0, 0.3}}),
                twist(0.5), R::kClear, 1, 1},
           Case{"floor", with_points(kOpen, three(0.4, 0.0, 0.04)), twist(0.5), R::kClear, 1, 1},
           Case{"on the floor", with_points(kOpen, three(0.4, 0.0, 0.06)), twist(0.5), R::kObstacle,
                0, 0.5},
           Case{"overhead", with_points(kOpen, three(0.4, 0.0, 0.61)), twist(0.5), R::kClear, 1, 1},
           Case{"its own parts", with_points(kOpen, three(0.2, 0.0)), twist(0.5), R::kClear, 1, 1},
           Case{"no number", with_points(kOpen, three(std::nan(""), 0.0)), twist(0.5), R::kClear, 1,
                1},
           Case{"rays that measured nothing", unmeasured, twist(0.5), R::kClear, 1, 1},
           Case{"covered", covered, twist(0.5), R::kTooFewRanges, 0, 0},
           Case{"covered, and something ahead", with_points(covered, three(0.6, 0.1)), twist(0.5),
                R::kTooFewRanges, 0, 0},
           Case{"covered but for rays at the floor", floor_alone, twist(0.5), R::kTooFewRanges, 0,
                0},
           Case{"rays that fall slowly", falling, twist(0.5), R::kClear, 1, 1},
           Case{"a camera of the way alone", scan_of_wall(100.0, 24.0), twist(0.5), R::kClear, 1,
                1},
           Case{"a quarter valid", thinned(kOpen, 4), twist(0.5), R::kTooFewRanges, 0, 0},
           Case{"a third valid", thinned(kOpen, 3), twist(0.5), R::kClear, 1, 1},
           Case{"covered, on the spot", covered, twist(0.0, 1.0), R::kClear, 1, 1},
           Case{"a camera ahead", narrow, twist(0.5), R::kClear, 1, 1},
           Case{"a camera ahead, slowly", narrow, twist(0.05), R::kClear, 1, 1},
           Case{"a camera ahead, backwards", narrow, twist(-0.5), R::kOutOfView, 0.199, 0.201},
           Case{"backwards as slowly as may be", narrow, twist(-0.1), R::kOutOfView, 1, 1},
           Case{"no rays", without_rays, twist(0.5), R::kOutOfView, 0.199, 0.201},
           Case{"rays that are no numbers", nowhere, twist(0.5), R::kOutOfView, 0.199, 0.201},
           Case{"no command", kOpen, twist(std::nan("")), R::kNonFinite, 0, 0},
           Case{"a command beyond all bounds", kOpen, twist(1e200), R::kNonFinite, 0, 0},
           Case{"a coarse scan", every(kOpen, 5), twist(0.5), R::kClear, 1, 1},
           Case{"a coarse scan, covered", thinned(every(kOpen, 5), 4), twist(0.5), R::kTooFewRanges,
                0, 0},
           Case{"no yaw rate", kOpen, twist(0.5, INFINITY), R::kNonFinite, 0, 0},
           Case{"old", scan_of_wall(100.0, 360.0, 9.5), twist(0.5), R::kStale, 0, 0},
           Case{"old, standing", scan_of_wall(100.0, 360.0, 9.5), twist(0.0), R::kStale, 0, 0},
           Case{"from the future", scan_of_wall(100.0, 360.0, 10.2), twist(0.5), R::kStale, 0, 0},
           Case{"no stamp", scan_of_wall(100.0, 360.0, std::nan("")), twist(0.5), R::kNonFinite, 0,
                0},
       }) {
    const RangeStopVerdict v = RangeStop().check(c.frame, c.command, 10.1);
    EXPECT_EQ(to_string(v.reason), to_string(c.reason)) << c.what << ": " << v.text;
    EXPECT_GE(v.share, c.least) << c.what << ": " << v.text;
    EXPECT_LE(v.share, c.most) << c.what << ": " << v.text;
    EXPECT_EQ(v.text.empty(), c.reason == R::kClear) << c.what;
    EXPECT_EQ(v.may_go_on(), v.share > 0.0);
  }
}

/// A depth image from the height 0.45 m of a floor at z = `floor` that ends at x = edge; beyond it
/// is one that is `deeper` [m], or nothing in range.
RangeFrame image_of_edge(double edge, double deeper, double floor = 0.0) {
  RangeFrame frame;
  frame.stamp = 10.0;
  frame.origin = {0.1, 0.0, floor + 0.45};
  for (double a = -30.0; a <= 30.0; a += 1.0) {
    for (double e = 1.0; e <= 27.0; e += 0.5) {
      const Eigen::Vector3d d(std::cos(e * kDegree) * std::cos(a * kDegree),
                              std::cos(e * kDegree) * std::sin(a * kDegree),
                              -std::sin(e * kDegree));
      double range = 0.45 / -d.z();
      if (frame.origin.x() + range * d.x() > edge) range = (0.45 + deeper) / -d.z();
      frame.rays.push_back(
          {frame.origin + std::min(range, kRange) * d, range < kRange ? Kind::kHit : Kind::kClear});
    }
  }
  return frame;
}

TEST(RangeStop, StopsBeforeTheFloorEnds) {
  RangeStopOptions options;
  for (const double floor : {0.0, -0.2}) {
    options.floor = floor;
    const RangeStop stop(options);
    for (const double deeper : {0.17, 1.0, 100.0}) {
      SCOPED_TRACE(deeper);
      const double edge = 1.2;
      const RangeFrame frame = image_of_edge(edge, deeper, floor);
      const RangeStopVerdict verdict = stop.check(frame, twist(1.5), 10.0);
      EXPECT_EQ(verdict.reason, RangeStopReason::kNoFloor);
      EXPECT_THAT(verdict.text, HasSubstr("no floor"));
      EXPECT_NEAR(verdict.point.x(), edge, 0.15);
      // What it may drive ends before the edge.
      const double v = 1.5 * verdict.share;
      EXPECT_LT(v * options.reaction_time + 0.5 * v * v / options.deceleration,
                edge - options.front);
      EXPECT_GT(verdict.share, 0.3);
      EXPECT_EQ(stop.check(frame, twist(-0.2), 10.0).reason, RangeStopReason::kOutOfView);
    }
    // A step that it takes, and a floor that goes on.
    for (const double deeper : {0.08, 0.0}) {
      EXPECT_EQ(stop.check(image_of_edge(1.2, deeper, floor), twist(1.5), 10.0).share, 1.0);
    }
  }
}

TEST(RangeStop, SaysWhatIsInTheWay) {
  const RangeStopVerdict v =
      RangeStop().check(with_points(kOpen, three(0.5, 0.1)), twist(0.5), 10.1);
  EXPECT_EQ(v.point, Eigen::Vector3d(0.5, 0.1, 0.3));
  // The disc with its margin has x = sqrt(0.3^2 - 0.1^2) at y = 0.1.
  EXPECT_NEAR(v.time_to_contact, (0.5 - std::sqrt(0.08)) / 0.5, 0.021);
  EXPECT_THAT(v.text, HasSubstr("(0.50, 0.10, 0.30)"));
}

// The share is what the formula gives: T(share) is the time to contact.
TEST(RangeStop, TheShareIsTheLargestThatStopsBeforeTheContact) {
  const RangeStopOptions o;
  for (const double v : {0.2, 0.5, 1.0, 2.0}) {
    for (const double wall : {0.35, 0.5, 0.8, 1.5, 3.0}) {
      const RangeStopVerdict verdict = RangeStop(o).check(scan_of_wall(wall), twist(v), 10.1);
      const double stop = v / o.deceleration, s = verdict.share;
      const double contact = (wall - 0.30) / v;
      const double full = 0.1 + o.reaction_time + 0.5 * stop;
      if (verdict.reason == RangeStopReason::kClear) {
        EXPECT_GE(contact, full - 0.02) << v << ' ' << wall;
        continue;
      }
      EXPECT_LE(contact, full) << v << ' ' << wall;
      const double taken = 0.1 + s * o.reaction_time + 0.5 * s * s * stop;
      EXPECT_TRUE(s == 0.0 ? contact <= 0.1 + 0.02 / v : taken <= contact + 1e-9);
      // Poses of the body are a centimetre apart, or a 200th of the way.
      const double pose = std::max(0.011, v * full / 200.0) / v;
      EXPECT_TRUE(s == 0.0 || taken >= contact - pose) << v << ' ' << wall;
    }
  }
}

// Of a body with corners, those sweep new ground when it turns: it does so slowly where it does not
// see, and not at all into what is there.
TEST(RangeStop, CornersTurnIntoWhatIsBesideThem) {
  RangeStopOptions o;
  o.left = o.right = 0.15;
  o.corner_radius = 0.02;
  const RangeStop stop(o);
  const RangeStopVerdict clear = stop.check(kOpen, twist(0.0, 1.0), 10.1);
  EXPECT_EQ(clear.reason, RangeStopReason::kClear) << clear.text;
  // The corner is at (0.25, 0.15); a post lies on its circle.
  const RangeStopVerdict post =
      stop.check(with_points(kOpen, three(0.15, 0.24)), twist(0.0, 1.0), 10.1);
  EXPECT_EQ(post.reason, RangeStopReason::kObstacle) << post.text;
  EXPECT_LT(post.share, 0.5);
  const RangeStopVerdict other_way =
      stop.check(with_points(kOpen, three(0.15, 0.24)), twist(0.0, -1.0), 10.1);
  EXPECT_EQ(other_way.reason, RangeStopReason::kClear) << other_way.text;
  const RangeStopVerdict blind = stop.check(scan_of_wall(100.0, 70.0), twist(0.0, 1.0), 10.1);
  EXPECT_EQ(blind.reason, RangeStopReason::kOutOfView) << blind.text;
  EXPECT_NEAR(blind.share, 0.1 / std::hypot(0.25, 0.15), 1e-9);
  o.rear = 0.5;
  o.right = 0.3;
  EXPECT_NEAR(RangeStop(o).check(scan_of_wall(100.0, 70.0), twist(0.0, 1.0), 10.1).share,
              0.1 / std::hypot(0.5, 0.3), 1e-9);
}

// Half of the way is enough, on whichever side: the outline goes around the whole body.
TEST(RangeStop, SeesEitherHalfOfTheWayOfABodyWithCorners) {
  RangeStopOptions o;
  o.corner_radius = 0.02;
  for (const double side : {1.0, -1.0}) {
    RangeFrame half = scan_of_wall(100.0, 60.0);
    std::erase_if(half.rays, [&](const RangeRay& ray) { return side * ray.point.y() < -1e-9; });
    const RangeStopVerdict v = RangeStop(o).check(half, twist(0.5), 10.1);
    EXPECT_EQ(v.reason, RangeStopReason::kClear) << side << ": " << v.text;
  }
}

// Within its margin a robot may drive away and along, not nearer.
TEST(RangeStop, OutOfItsMarginItMayLeave) {
  const RangeFrame beside = with_points(kOpen, three(0.0, 0.27));  // 2 cm beside the body
  EXPECT_EQ(RangeStop().check(beside, twist(0.5), 10.1).share, 1.0);
  EXPECT_EQ(RangeStop().check(beside, twist(0.0, 0.0, -0.5), 10.1).share, 1.0);
  EXPECT_EQ(RangeStop().check(beside, twist(0.0, 0.0, 0.5), 10.1).share, 0.0);
}

// A base with a delay drives at a wall with what the check allows: it stops before it, whatever its
// speed and the age of the frames.
TEST(RangeStop, ABaseThatObeysStopsBeforeTheWall) {
  constexpr double kPeriod = 0.05;
  for (const double wanted : {0.3, 1.2}) {
    for (const int frames_late : {0, 4}) {
      const RangeStop stop;
      const double wall = 2.0;
      double x = 0.0, v = 0.0;
      std::vector<double> path, asked;
      double nearest = wall;
      for (int n = 0; n < 200; ++n) {
        path.push_back(x);
        const auto seen = static_cast<std::size_t>(std::max(0, n - frames_late));
        const double now = 10.0 + kPeriod * n;
        const double stamp = 10.0 + kPeriod * static_cast<double>(seen);
        const RangeFrame frame = scan_of_wall(wall - path[seen], 90.0, stamp);
        asked.push_back(stop.check(frame, twist(wanted), now).share * wanted);
        // The base follows three periods later, and brakes no harder than it is said to.
        const double goal = asked[static_cast<std::size_t>(std::max(0, n - 3))];
        v = std::clamp(goal, v - 0.5 * kPeriod, v + 0.5 * kPeriod);
        x += v * kPeriod;
        nearest = std::min(nearest, wall - x - 0.25);
      }
      EXPECT_GT(nearest, 0.0) << wanted << " m/s, " << frames_late << " frames late";
      EXPECT_LT(v, 0.05) << wanted << " m/s, " << frames_late << " frames late";
      EXPECT_LT(nearest, 0.1 + wanted * kPeriod * frames_late + 0.05);
    }
  }
}

TEST(RangeStop, RefusesOptionsThatDoNotFit) {
  struct Case {
    RangeStopOptions options;
    const char* message;
  };
  RangeStopOptions corner, heights, front;
  corner.corner_radius = 0.3;
  heights.highest = 0.0;
  front.front = 0.0;
  for (const Case& c : {Case{corner, "corner_radius: more than half of a side"},
                        Case{heights, "highest: not above lowest"}, Case{front, "front is 0"}}) {
    try {
      RangeStop stop(c.options);
      FAIL() << c.message;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message));
    }
  }
}

// What it knows of a robot that nobody has measured.
TEST(RangeStopOptions, AreTheBodysOutline) {
  RobotDescription robot;
  robot.model = std::make_shared<const Unicycle>();
  robot.shape = CylinderShape{};
  const RangeStopOptions round = range_stop_options(robot);
  const double radius = circumscribed_radius(robot.shape);
  for (const double side :
       {round.front, round.rear, round.left, round.right, round.corner_radius}) {
    EXPECT_EQ(side, radius);
  }
  EXPECT_EQ(round.highest, robot.slice().z_max);
  EXPECT_GE(round.lowest, 0.05);
  EXPECT_EQ(round.deceleration, robot.model->max_deceleration());
  robot.shape = BoxShape{{0.1, 0.0, 0.3}, {0.6, 0.4, 0.6}};
  const RangeStopOptions box = range_stop_options(robot);
  EXPECT_NEAR(box.front, 0.4, 1e-12);
  EXPECT_NEAR(box.rear, 0.2, 1e-12);
  EXPECT_NEAR(box.left, 0.2, 1e-12);
  EXPECT_EQ(box.corner_radius, 0.0);
  EXPECT_NO_THROW(RangeStop{round});
  EXPECT_NO_THROW(RangeStop{box});
}

}  // namespace
}  // namespace prospect::range_stop_test

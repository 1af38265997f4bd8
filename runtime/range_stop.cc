// SPDX-License-Identifier: Apache-2.0
#include "runtime/range_stop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFarthestStop = 1000.0;  // [m] beyond it a command is no command

/// Where a point of B stands after `time` on the arc of a command, in B at its start.
struct Arc {
  double vx, vy, w;
  struct Placed {
    Eigen::Vector2d position;
    double cosine, sine;
    Eigen::Vector2d in(const Eigen::Vector2d& p) const {  // B there -> B at the start
      return position +
             Eigen::Vector2d(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y());
    }
    Eigen::Vector2d seen_from(const Eigen::Vector2d& p) const {
      const Eigen::Vector2d d = p - position;
      return {cosine * d.x() + sine * d.y(), cosine * d.y() - sine * d.x()};
    }
  };
  Placed at(double time) const {
    const double angle = w * time, half = std::sin(0.5 * angle);
    const double along = std::abs(w) < 1e-9 ? time : std::sin(angle) / w;
    const double aside = std::abs(w) < 1e-9 ? 0.0 : 2.0 * half * half / w;
    return {{along * vx - aside * vy, along * vy + aside * vx}, std::cos(angle), std::sin(angle)};
  }
};

template <typename... Numbers>
RangeStopVerdict stopped(double share, RangeStopReason reason, const char* pattern,
                         Numbers... numbers) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, numbers...);
  RangeStopVerdict verdict;
  verdict.share = share;
  verdict.reason = reason;
  verdict.text = text;
  return verdict;
}

}  // namespace

std::string_view to_string(RangeStopReason reason) {
  switch (reason) {
    case RangeStopReason::kClear:
      return "clear";
    case RangeStopReason::kObstacle:
      return "obstacle";
    case RangeStopReason::kNoFloor:
      return "no floor";
    case RangeStopReason::kTooFewRanges:
      return "too few ranges";
    case RangeStopReason::kOutOfView:
      return "out of view";
    case RangeStopReason::kStale:
      return "stale";
    case RangeStopReason::kNonFinite:
      return "non-finite";
  }
  return "?";
}

RangeStop::RangeStop(const RangeStopOptions& options) : options_(options) {
  check_knobs("range stop", options_);
  const RangeStopOptions& o = options_;
  // Round corners, and the sides between them.
  const double r = o.corner_radius;
  const Eigen::Vector2d corners[] = {{o.front - r, o.left - r},
                                     {-o.rear + r, o.left - r},
                                     {-o.rear + r, -o.right + r},
                                     {o.front - r, -o.right + r}};
  constexpr int kParts = 8;  // of a corner and of a side
  for (int n = 0; n < 4; ++n) {
    const Eigen::Vector2d side = corners[(n + 1) % 4] - corners[n];
    for (int part = 0; part < 2 * kParts; ++part) {
      const double turned = std::min(1.0, static_cast<double>(part) / kParts);
      const double along = std::max(0.0, static_cast<double>(part) / kParts - 1.0);
      const double angle = 0.5 * kPi * (n + turned);
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      outline_.push_back({corners[n] + along * side + r * normal, normal});
    }
  }
}

double RangeStop::distance_to_body(const Eigen::Vector2d& p) const {
  const RangeStopOptions& o = options_;
  const double x = std::max(p.x() - o.front, -o.rear - p.x()) + o.corner_radius;
  const double y = std::max(p.y() - o.left, -o.right - p.y()) + o.corner_radius;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) -
         o.corner_radius;
}

RangeStopVerdict RangeStop::in_view(const RangeFrame& frame, const Twist& command,
                                    double time) const {
  constexpr int kBins = 120;
  const RangeStopOptions& o = options_;
  const auto bin_of = [](double x, double y) {
    return static_cast<std::size_t>((std::atan2(y, x) + kPi) / (2.0 * kPi) * kBins) % kBins;
  };
  const Arc arc{command.linear.x(), command.linear.y(), command.yaw_rate};
  const Arc::Placed end = arc.at(time);
  std::array<bool, kBins> counts{};
  double farthest = 0.0;
  for (const OutlinePoint& at : outline_) {
    const Eigen::Vector2d motion(arc.vx - arc.w * at.point.y(), arc.vy + arc.w * at.point.x());
    if (motion.isZero(0.0) || motion.dot(at.normal) < std::sqrt(0.5) * motion.norm()) continue;
    const Eigen::Vector2d ahead = end.in(at.point);
    if (distance_to_body(ahead) < 1e-3) continue;
    const Eigen::Vector2d from = ahead - frame.origin.head<2>();
    counts[bin_of(from.x(), from.y())] = true;
    farthest = std::max(farthest, from.norm());
  }
  std::array<int, kBins> all{}, valid{};
  for (const RangeRay& ray : frame.rays) {
    if (!ray.point.allFinite()) continue;
    const Eigen::Vector3d d = ray.point - frame.origin;
    const double level = d.head<2>().norm();
    const double height = frame.origin.z() + d.z() / level * farthest;
    if (!(height >= o.lowest && height <= o.highest)) continue;
    const std::size_t bin = bin_of(d.x(), d.y());
    ++all[bin];
    valid[bin] += ray.kind != RangeRay::Kind::kInvalid;
  }
  // Rays of a scan may be farther apart than a bin is wide: the bins beside count as well.
  int directions = 0, seen = 0, rays = 0, good = 0;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    const std::size_t next = (bin + 1) % kBins, last = (bin + kBins - 1) % kBins;
    if (counts[bin]) {
      ++directions;
      seen += all[bin] + all[next] + all[last] > 0;
    }
    if (counts[bin] || counts[next] || counts[last]) {
      rays += all[bin];
      good += valid[bin];
    }
  }
  RangeStopVerdict clear;
  clear.share = 1.0;
  clear.reason = RangeStopReason::kClear;
  if (directions == 0) return clear;
  if (2 * seen < directions) {
    const double radius = std::hypot(std::max(o.front, o.rear), std::max(o.left, o.right));
    const double fastest = command.linear.head<2>().norm() + std::abs(command.yaw_rate) * radius;
    return stopped(std::min(1.0, o.blind_speed / fastest), RangeStopReason::kOutOfView,
                   "no ray looks in %d of %d directions that the body drives in", directions - seen,
                   directions);
  }
  if (good < o.least_valid * rays) {
    return stopped(0.0, RangeStopReason::kTooFewRanges,
                   "%d of %d rays in the driven direction are valid; expected %.0f %%", good, rays,
                   100.0 * o.least_valid);
  }
  return clear;
}

RangeStopVerdict RangeStop::check(const RangeFrame& frame, const Twist& command, double now) const {
  const RangeStopOptions& o = options_;
  const double age = now - frame.stamp;
  if (!command.linear.allFinite() || !std::isfinite(command.yaw_rate) || !std::isfinite(age) ||
      !frame.origin.allFinite()) {
    return stopped(0.0, RangeStopReason::kNonFinite,
                   "the command, a time or the origin is no number");
  }
  if (age > o.max_age || age < -1e-3) {
    return stopped(0.0, RangeStopReason::kStale, "the ranges are %.2f s old; expected 0 to %.2f s",
                   age, o.max_age);
  }
  const Arc arc{command.linear.x(), command.linear.y(), command.yaw_rate};
  const double speed = std::hypot(arc.vx, arc.vy);
  const double stop = std::max(speed / o.deceleration, std::abs(arc.w) / o.yaw_deceleration);
  const double passed = std::max(age, 0.0);
  const double time = passed + o.reaction_time + 0.5 * stop;

  // Poses so close that no point of the body moves by more than a centimetre, or a 200th of the
  // way.
  const double radius = std::hypot(std::max(o.front, o.rear), std::max(o.left, o.right));
  const double reach = (speed + std::abs(arc.w) * radius) * time;
  if (!(reach <= kFarthestStop)) {
    return stopped(0.0, RangeStopReason::kNonFinite, "the command needs more than %g m to stop",
                   kFarthestStop);
  }
  RangeStopVerdict verdict = in_view(frame, command, time);
  const int steps = static_cast<int>(std::clamp(std::ceil(reach / 0.01), 1.0, 200.0));
  std::vector<Arc::Placed> poses;
  for (int n = 1; n <= steps; ++n) poses.push_back(arc.at(time * n / steps));
  struct Contact {
    int pose;  // the last free one
    Eigen::Vector3d point;
    bool no_floor;
  };
  std::vector<Contact> contacts;
  const double above = frame.origin.z() - o.floor;
  for (const RangeRay& ray : frame.rays) {
    Eigen::Vector3d p = ray.point;
    if (ray.kind == RangeRay::Kind::kInvalid || !p.allFinite()) continue;
    const bool no_floor = p.z() < o.floor - o.drop && above > 0.0;
    if (no_floor) {
      p = frame.origin + above / (frame.origin.z() - p.z()) * (p - frame.origin);
      p.z() = o.floor;
    } else if (ray.kind != RangeRay::Kind::kHit || p.z() < o.lowest || p.z() > o.highest) {
      continue;
    }
    const Eigen::Vector2d q = p.head<2>();
    const double distance = distance_to_body(q);
    if (distance <= 0.0 || distance > reach + o.margin) continue;
    const double least = std::min(o.margin, 0.9 * distance);
    const auto met = std::find_if(poses.begin(), poses.end(), [&](const Arc::Placed& pose) {
      return distance_to_body(pose.seen_from(q)) <= least;
    });
    if (met != poses.end())
      contacts.push_back({static_cast<int>(met - poses.begin()), p, no_floor});
  }
  const auto least = static_cast<std::size_t>(o.least_points);
  if (contacts.size() < least) return verdict;
  const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(least - 1);
  std::nth_element(contacts.begin(), first, contacts.end(),
                   [](const auto& a, const auto& b) { return a.pose < b.pose; });
  const double contact = time * first->pose / steps;
  // age + s reaction + s^2 stop / 2 = contact; stop > 0, as the robot moves.
  const double left = std::max(0.0, contact - passed);
  const double share =
      (std::sqrt(o.reaction_time * o.reaction_time + 2.0 * stop * left) - o.reaction_time) / stop;
  if (share >= verdict.share) return verdict;
  const Eigen::Vector3d point = first->point;
  verdict = first->no_floor ? stopped(share, RangeStopReason::kNoFloor,
                                      "no floor at (%.2f, %.2f) m in B, %.2f s ahead", point.x(),
                                      point.y(), contact)
                            : stopped(share, RangeStopReason::kObstacle,
                                      "something at (%.2f, %.2f, %.2f) m in B, %.2f s ahead",
                                      point.x(), point.y(), point.z(), contact);
  verdict.point = point;
  verdict.time_to_contact = contact;
  return verdict;
}

}  // namespace prospect

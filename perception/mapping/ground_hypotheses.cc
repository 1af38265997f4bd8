// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/ground_hypotheses.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "perception/mapping/pose_check.h"

namespace prospect {
namespace {

constexpr std::size_t kMostPlanes = 8;
constexpr std::size_t kMostViews = 64;
constexpr std::size_t kMostCells = 1024;
constexpr double kCell = 0.1;    // [m]
constexpr double kBelow = 0.05;  // [m]: no noise of a plane
constexpr double kMost = 0.5;    // of what was seen
constexpr double kHardly = 0.1;  // of what was seen
/// [m^2] over which a floor and the depths of it err alike, in every view.
constexpr double kAlike = 0.25;
constexpr double kWithin = 3.0;           // [standard deviations]
constexpr double kTrackTilt = 0.1;        // [rad]: where the one taken is looked for
constexpr double kTrackHeight = 0.12;     // [m]
constexpr double kMostBelowStated = 1.0;  // points below the height stated, of those on it
constexpr int kMostDoubts = 10;
constexpr int kMostDrawsBeside = 3000;  // for planes beside the one taken: a sixth of the points
constexpr double kWeightOfPrior = 0.5;  // of view_sigma against the spread of views, in views

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char line[160];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

}  // namespace

GroundHypotheses::GroundHypotheses(const PinholeCamera& camera,
                                   const GroundHypothesesOptions& options)
    : camera_(camera), options_(options) {
  validate(camera);
}

const GroundHypothesis* GroundHypotheses::taken() const {
  for (const GroundHypothesis& h : shown_) {
    if (h.taken) return &h;
  }
  return nullptr;
}

const GroundHypotheses::Plane* GroundHypotheses::plane_taken() const {
  for (const Plane& plane : planes_) {
    if (plane.state.number == taken_) return &plane;
  }
  return nullptr;
}

std::uint64_t GroundHypotheses::cell_of(const Plane& plane, const Eigen::Vector3d& p) const {
  const auto index = [](double x) {
    return static_cast<std::uint32_t>(
        static_cast<std::int32_t>(std::clamp(std::floor(x / kCell), -2e9, 2e9)));
  };
  return static_cast<std::uint64_t>(index(plane.u.dot(p))) << 32 | index(plane.v.dot(p));
}

GroundHypotheses::Plane* GroundHypotheses::match(const View& view, const Eigen::Vector3d& middle) {
  Plane* best = nullptr;
  double least = options_.height_tolerance;
  for (Plane& plane : planes_) {
    if (angle_between(plane.state.normal, view.normal) > options_.tilt_tolerance) continue;
    const double off = std::abs(plane.state.normal.dot(middle) + plane.state.offset);
    if (off > least) continue;
    least = off;
    best = &plane;
  }
  return best;
}

/// visit(p) for the points by which hypotheses are scored.
template <typename Visit>
void GroundHypotheses::each_point(const DepthImage& image, Visit visit) const {
  const int first = std::max(1, options_.ground.stride) / 2;
  const int step = std::max(1, options_.ground.score_stride);
  for (int v = first; v < image.height; v += step) {
    for (int u = first; u < image.width; u += step) {
      const double z = image.at(u, v);
      if (options_.ground.range.holds(z)) visit(Eigen::Vector3d(z * pixel_ray(camera_, u, v)));
    }
  }
}

int GroundHypotheses::enter(const Found& found, const std::vector<int>& seen,
                            const DepthImage& image, const Eigen::Isometry3d& T_DC) {
  View view;
  view.normal = T_DC.linear() * found.plane.normal;
  view.eye = T_DC.translation();
  view.orientation = T_DC.linear();
  view.height = found.plane.height;
  view.covariance = found.plane.covariance;
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  each_point(image, [&](const Eigen::Vector3d& p) {
    const double sigma = ground_sigma(found.plane.height, p.z(), options_.ground);
    if (std::abs(found.plane.above(p)) >= options_.ground.gate * sigma) return;
    points.push_back(T_DC * p);
    middle += points.back();
  });
  if (points.empty()) return -1;
  middle /= static_cast<double>(points.size());

  Plane* plane = match(view, middle);
  for (Plane& known : planes_) {
    if (known.state.number == found.number) plane = &known;
  }
  if (plane != nullptr && std::find(seen.begin(), seen.end(), plane->state.number) != seen.end()) {
    return -1;
  }
  if (plane == nullptr) {
    if (planes_.size() >= kMostPlanes) {
      auto least = planes_.end();
      for (auto it = planes_.begin(); it != planes_.end(); ++it) {
        if (it->state.number == taken_) continue;
        if (least == planes_.end() || it->state.frames < least->state.frames) least = it;
      }
      planes_.erase(least);
    }
    planes_.emplace_back();
    plane = &planes_.back();
    plane->state.number = next_++;
    plane->state.normal = view.normal;
    plane->state.offset = view.height - view.normal.dot(view.eye);
    ground_tangents(view.normal, plane->u, plane->v);
  }
  ++plane->state.frames;
  for (const Eigen::Vector3d& p : points) {
    const std::uint64_t cell = cell_of(*plane, p);
    if (plane->cells.size() < kMostCells || plane->cells.count(cell)) {
      plane->cells.try_emplace(cell, Sighting{p, view.eye});
    }
  }
  plane->state.area = kCell * kCell * static_cast<double>(plane->cells.size());
  const bool same_view =
      options_.poses && !plane->views.empty() &&
      (plane->views.back().eye - view.eye).norm() < options_.view_distance &&
      Eigen::AngleAxisd(plane->views.back().orientation.transpose() * view.orientation).angle() <
          options_.view_angle;
  if (same_view) return plane->state.number;
  if (plane->views.size() >= kMostViews) plane->views.erase(plane->views.begin());
  plane->views.push_back(view);
  estimate(*plane);
  return plane->state.number;
}

/// Of what all views of a plane share, as the header says; of (theta_1, theta_2, height at the
/// origin).
Eigen::Matrix3d GroundHypotheses::shared_covariance(const Plane& plane, const Eigen::Vector3d& t1,
                                                    const Eigen::Vector3d& t2,
                                                    const Eigen::Vector3d& origin) const {
  const GroundPrior& prior = options_.prior;
  const double tilt = 1.0 / (prior.tilt_tolerance * prior.tilt_tolerance);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.diagonal() << tilt, tilt, 1.0 / (prior.height_tolerance * prior.height_tolerance);
  for (const auto& [cell, seen] : plane.cells) {
    const double height = plane.state.normal.dot(seen.eye) + plane.state.offset;
    const double sigma =
        ground_sigma(height, std::max(kCell, (seen.point - seen.eye).norm()), options_.ground);
    const Eigen::Vector3d away = seen.point - origin;
    const Eigen::Vector3d J(t1.dot(away), t2.dot(away), 1.0);
    information += kCell * kCell / (kAlike * sigma * sigma) * J * J.transpose();
  }
  return information.inverse();
}

/// Unknowns: how the normal tips (theta_1, theta_2) and how much higher the first frame's camera is
/// above the plane, from where the hypothesis stands.
void GroundHypotheses::estimate(Plane& plane) const {
  GroundHypothesis& h = plane.state;
  const Eigen::Vector3d n = h.normal, origin = first_.translation();
  const double height = n.dot(origin) + h.offset;
  Eigen::Vector3d t1, t2;
  ground_tangents(n, t1, t2);
  struct Row {
    Eigen::Matrix3d H, C;
    Eigen::Vector3d z;
  };
  std::vector<Row> rows;
  for (const View& view : plane.views) {
    Row row;
    const Eigen::Vector3d away = view.eye - origin;
    row.H << 1, 0, 0, 0, 1, 0, t1.dot(away), t2.dot(away), 1;
    row.z << t1.dot(view.normal), t2.dot(view.normal), view.height - n.dot(away) - height;
    // Its covariance is in the tangents of its own normal as its camera saw it.
    Eigen::Vector3d c1, c2;
    ground_tangents(view.orientation.transpose() * view.normal, c1, c2);
    const Eigen::Vector3d d1 = view.orientation * c1, d2 = view.orientation * c2;
    Eigen::Matrix3d turn;
    turn << t1.dot(d1), t1.dot(d2), 0, t2.dot(d1), t2.dot(d2), 0, 0, 0, 1;
    row.C = turn * view.covariance * turn.transpose();
    rows.push_back(row);
  }
  const Eigen::Matrix3d shared = shared_covariance(plane, t1, t2, first_.translation());
  const double tilt0 = options_.view_sigma_tilt * options_.view_sigma_tilt;
  const double height0 = options_.view_sigma_height * options_.view_sigma_height;
  double tau_tilt = tilt0, tau_height = height0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance;
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Row& row : rows) {
      Eigen::Matrix3d C = row.C;
      C.diagonal() += Eigen::Vector3d(tau_tilt, tau_tilt, tau_height);
      const Eigen::Matrix3d W = C.inverse();
      information += row.H.transpose() * W * row.H;
      right += row.H.transpose() * W * row.z;
    }
    covariance = information.inverse();
    x = covariance * right;
    covariance += shared;
    if (options_.height) {
      const Eigen::Matrix3d views = covariance.inverse();
      Eigen::Vector3d both = views * x;
      information = views;
      const double w = 1.0 / (options_.sigma_height * options_.sigma_height);
      information(2, 2) += w;
      both[2] += w * (*options_.height - height);
      covariance = information.inverse();
      x = covariance * both;
    }
    double tilt = 0.0, high = 0.0;
    for (const Row& row : rows) {
      const Eigen::Vector3d e = row.z - row.H * x;
      tilt += 0.5 * (e.head<2>().squaredNorm() - row.C(0, 0) - row.C(1, 1));
      high += e.z() * e.z() - row.C(2, 2);
    }
    const auto more = static_cast<double>(rows.size()) - 1.0;
    tau_tilt = std::max(0.0, kWeightOfPrior * tilt0 + tilt) / (kWeightOfPrior + more);
    tau_height = std::max(0.0, kWeightOfPrior * height0 + high) / (kWeightOfPrior + more);
    if (rows.size() < 2) {
      tau_tilt = tilt0;
      tau_height = height0;
    }
  }
  h.normal = (n + x[0] * t1 + x[1] * t2).normalized();
  h.height = height + x[2];
  h.offset = h.height - h.normal.dot(origin);
  // In the tangents of the normal as the first frame's camera sees it.
  GroundPlane first;
  first.normal = first_.linear().transpose() * h.normal;
  first.height = h.height;
  Eigen::Vector3d c1, c2;
  ground_tangents(first.normal, c1, c2);
  const Eigen::Vector3d d1 = first_.linear() * c1, d2 = first_.linear() * c2;
  Eigen::Matrix3d turn;
  turn << d1.dot(t1), d1.dot(t2), 0, d2.dot(t1), d2.dot(t2), 0, 0, 0, 1;
  first.covariance = turn * covariance * turn.transpose();
  if (!options_.poses) {
    // The camera looks from the same place each time, and what its images share stays.
    first.covariance.diagonal() += Eigen::Vector3d(tilt0, tilt0, height0);
  }
  h.covariance = first.covariance;
  h.pitch = first.pitch();
  h.roll = first.roll();
  h.sigma_height = first.sigma_height();
  h.sigma_tilt = first.sigma_tilt();
}

/// Most of what was seen of b lies below a, or some of it.
bool GroundHypotheses::is_below(const Plane& b, const Plane& a, bool mostly) const {
  int below = 0;
  for (const auto& [cell, seen] : b.cells) {
    below += a.state.normal.dot(seen.point) + a.state.offset < -kBelow;
  }
  return below > (mostly ? kMost : kHardly) * static_cast<double>(b.cells.size());
}

/// The rays to what was seen of b pass through what was seen of a.
bool GroundHypotheses::is_seen_through(const Plane& b, const Plane& a) const {
  if (!options_.poses) return false;
  int through = 0;
  for (const auto& [cell, seen] : b.cells) {
    const double from = a.state.normal.dot(seen.eye) + a.state.offset;
    const double to = a.state.normal.dot(seen.point) + a.state.offset;
    if (!(from > 0.0 && to < -kBelow)) continue;
    const Eigen::Vector3d pierced = seen.eye + from / (from - to) * (seen.point - seen.eye);
    through += a.cells.count(cell_of(a, pierced)) > 0;
  }
  return through > kMost * static_cast<double>(b.cells.size());
}

bool GroundHypotheses::beats(const Plane& b, const Plane& a) const {
  if (is_below(b, a, true) && !is_below(a, b, false)) {
    return b.state.frames >= 2 * a.state.frames || !is_seen_through(b, a);
  }
  if (is_below(a, b, true) && !is_below(b, a, false)) {
    return b.state.frames >= 2 * a.state.frames && is_seen_through(a, b);
  }
  return b.state.admitted >= 2 * a.state.admitted;
}

bool GroundHypotheses::as_high_as_stated(const Plane& plane) const {
  if (!options_.height) return true;
  // Of the views alone: the estimate contains what was stated.
  const View& view = plane.views.front();
  const double own =
      plane.state.normal.dot(first_.translation()) + view.height - plane.state.normal.dot(view.eye);
  const double sigma = std::sqrt(options_.sigma_height * options_.sigma_height +
                                 options_.view_sigma_height * options_.view_sigma_height);
  return std::abs(own - *options_.height) <= kWithin * sigma;
}

/// What keeps a plane from being taken, whatever else there is; empty: nothing.
std::string GroundHypotheses::obstacle(const Plane& plane, int least_frames) const {
  if (!as_high_as_stated(plane)) {
    return text("the camera is said to be %.2f +- %.2f m high", *options_.height,
                options_.sigma_height);
  }
  if (plane.state.frames < least_frames) {
    return text("seen in %.0f frames, %.0f must agree", plane.state.frames, least_frames);
  }
  if (plane.state.area < options_.least_area) {
    return text("%.2f m^2 of it seen, %.2f must be", plane.state.area, options_.least_area);
  }
  return "";
}

/// Whether another one is taken than before.
bool GroundHypotheses::choose(int least_frames) {
  Plane* best = nullptr;
  std::vector<Plane*> fit;
  for (Plane& plane : planes_) {
    plane.state.taken = false;
    plane.state.why = obstacle(plane, least_frames);
    if (plane.state.number == taken_ && as_high_as_stated(plane)) plane.state.why.clear();
    if (!plane.state.why.empty()) continue;
    fit.push_back(&plane);
    if (best != nullptr && best->state.number == taken_) continue;
    if (best == nullptr || plane.state.number == taken_ ||
        plane.state.frames > best->state.frames) {
      best = &plane;
    }
  }
  for (std::size_t round = 0; round < fit.size(); ++round) {
    Plane* better = nullptr;
    for (Plane* other : fit) {
      if (other != best && better == nullptr && beats(*other, *best)) better = other;
    }
    if (better == nullptr) break;
    best = better;
  }
  if (best == nullptr) {
    const bool changed = taken_ >= 0;
    taken_ = -1;
    return changed;
  }
  const bool changed = best->state.number != taken_;
  taken_ = best->state.number;
  best->state.taken = true;
  const std::string it = "hypothesis " + std::to_string(taken_);
  for (Plane* other : fit) {
    if (other == best) continue;
    const Eigen::Vector3d eye = first_.translation();
    const double apart = other->state.normal.dot(eye) + other->state.offset -
                         best->state.normal.dot(eye) - best->state.offset;
    if (is_below(*best, *other, true)) {
      other->state.why = it + text(" lies %.2f m below it", -apart);
    } else if (is_below(*other, *best, true) && is_seen_through(*other, *best)) {
      other->state.why = "seen through " + it + ": a reflection or a wrong depth";
    } else {
      other->state.why =
          text("tilted by %.1f deg against ",
               angle_between(other->state.normal, best->state.normal) * 180.0 / M_PI) +
          it + ", which was there first or is shown by more frames";
    }
  }
  best->state.why = fit.size() > 1 ? "no other lies below it and is shown by enough frames"
                                   : "the only one that enough frames agree on";
  if (best->state.frames < options_.least_frames) {
    best->state.why = text("the best there is: seen in %.0f frames, %.0f should agree",
                           best->state.frames, options_.least_frames);
  }
  if (options_.height) {
    best->state.why +=
        text("; as high as stated, %.2f +- %.2f m", *options_.height, options_.sigma_height);
  }
  return changed;
}

/// Whether a camera may be `height` above the ground with `up` there, in C.
bool GroundHypotheses::admits(const Eigen::Vector3d& up, double height) const {
  const GroundPrior& prior = options_.prior;
  return angle_between(up, prior.up) <= prior.tilt_tolerance &&
         std::abs(height - prior.height) <= prior.height_tolerance;
}

/// The planes in an image that may be the ground, found as the header says; `reason`: why not the
/// one looked for first.
std::vector<GroundHypotheses::Found> GroundHypotheses::view(const DepthImage& image,
                                                            const Eigen::Isometry3d& T_DC,
                                                            std::string& reason) const {
  std::vector<Found> found;
  GroundPlaneOptions beside = options_.ground;
  if (taken_ >= 0) beside.most_draws = std::min(beside.most_draws, kMostDrawsBeside);
  const auto add_below = [&](const GroundPlane& plane) {
    for (const GroundPlane& lower :
         find_planes_below(camera_, image, options_.prior, plane, beside)) {
      found.push_back({lower, -1});
    }
  };
  bool known = false;
  if (const Plane* taken = plane_taken()) {
    GroundPlane expected;
    expected.normal = T_DC.linear().transpose() * taken->state.normal;
    expected.height = taken->state.normal.dot(T_DC.translation()) + taken->state.offset;
    GroundPrior prior;
    prior.up = expected.normal;
    prior.height = expected.height;
    prior.tilt_tolerance = options_.poses ? kTrackTilt : options_.tilt_tolerance;
    prior.height_tolerance = options_.poses ? kTrackHeight : options_.height_tolerance;
    const GroundPlane again = find_ground(camera_, image, prior, options_.ground);
    if (again.found) found.push_back({again, taken_});
    if (!again.found) reason = again.reason;
    known = again.found && admits(expected.normal, expected.height);
    int depths = 0, lower = 0;
    each_point(image, [&](const Eigen::Vector3d& p) {
      const double sigma = ground_sigma(expected.height, p.z(), options_.ground);
      ++depths;
      lower += expected.above(p) < -std::max(kBelow, options_.ground.gate * sigma);
    });
    if (lower > 0 && lower >= options_.ground.min_share * depths) {
      add_below(again.found ? again : expected);
    }
  }
  if (known) return found;
  if (options_.height && taken_ < 0) {
    GroundPrior stated = options_.prior;
    stated.height = *options_.height;
    stated.height_tolerance = kWithin * options_.sigma_height;
    GroundPlaneOptions options = options_.ground;
    options.most_below = kMostBelowStated;
    const GroundPlane there = find_ground(camera_, image, stated, options);
    if (there.found) found.push_back({there, -1});
  }
  const GroundPlane any = find_ground(camera_, image, options_.prior, beside);
  if (any.found) found.push_back({any, -1});
  if (!any.found) reason = any.reason;
  // Also below one that too much lies below to be found.
  if (any.height > 0.0) add_below(any);
  return found;
}

GroundObservation GroundHypotheses::add(const DepthImage& image, const Eigen::Isometry3d& T_DC) {
  GroundObservation out;
  const auto refused = [&out](const char* why) {
    out.reason = why;
    return out;
  };
  if (!image.whole() || image.width != camera_.width || image.height != camera_.height) {
    return refused("the image has the wrong size");
  }
  if (!is_pose(T_DC)) return refused("the pose is no rotation and translation");
  if (last_image_.same(image)) return refused("the image is frozen");
  last_image_ = image;
  if (!any_) first_ = T_DC;
  any_ = true;
  std::vector<int> seen;
  for (const Found& found : view(image, T_DC, out.reason)) {
    const int number = enter(found, seen, image, T_DC);
    if (number >= 0) seen.push_back(number);
  }
  out.seen = static_cast<int>(seen.size());
  if (out.seen > 0) out.reason.clear();
  for (Plane& plane : planes_) {
    const double height = plane.state.normal.dot(T_DC.translation()) + plane.state.offset;
    plane.state.admitted += std::find(seen.begin(), seen.end(), plane.state.number) != seen.end() &&
                            admits(T_DC.linear().transpose() * plane.state.normal, height);
  }
  const bool had = taken_ >= 0;
  out.changed = choose(options_.least_frames);
  if (out.changed) doubts_ = 0;
  const Plane* const taken = plane_taken();
  if (had && !out.changed && taken != nullptr && doubts_ < kMostDoubts) {
    for (const Plane& plane : planes_) {
      const bool young = plane.state.number != taken_ &&
                         plane.state.frames < options_.least_frames && as_high_as_stated(plane) &&
                         is_below(plane, *taken, true);
      out.doubtful = out.doubtful || (young && std::find(seen.begin(), seen.end(),
                                                         plane.state.number) != seen.end());
    }
    doubts_ += out.doubtful;
  }
  show();
  return out;
}

bool GroundHypotheses::settle() {
  if (taken_ >= 0 || !choose(1)) return false;
  show();
  return true;
}

void GroundHypotheses::show() {
  shown_.clear();
  for (const Plane& plane : planes_) shown_.push_back(plane.state);
}

}  // namespace prospect

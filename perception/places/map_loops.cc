// SPDX-License-Identifier: Apache-2.0
#include "perception/places/map_loops.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/maps/planar_error.h"
#include "models/formatted.h"
#include "perception/places/submap_alignment.h"

namespace prospect {
namespace {

constexpr int kIterations = 10;  // of the graph in a piece of work
constexpr int kBricks = 500;     // of evidence
constexpr int kCovariances = 8;
constexpr double kLeastPosition = 2e-3, kLeastYaw = 5e-4;  // [m], [rad]: odometry is no surer

PlanarMove move_of(const Pose& pose) { return {pose.position.head<2>(), pose.yaw}; }

Eigen::Isometry3d in_space(const PlanarMove& move) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear()(0, 0) = T.linear()(1, 1) = std::cos(move.yaw);
  T.linear()(1, 0) = std::sin(move.yaw);
  T.linear()(0, 1) = -T.linear()(1, 0);
  T.translation().head<2>() = move.shift;
  return T;
}

RelativePose relative(const AnchorStep& step) {
  constexpr double kSure = 1e6;  // of directions in which planar poses do not differ
  RelativePose measured;
  measured.T = in_space(step.way);
  measured.information.setZero();
  measured.information.diagonal().setConstant(kSure);
  const Eigen::Matrix3d inverse = step.covariance.inverse();
  const Eigen::Vector3i planar(0, 1, 5);
  measured.information(planar, planar) = 0.5 * (inverse + inverse.transpose());
  return measured;
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double yaw) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  return R * covariance * R.transpose();
}

double least_distance(const MapAnchor& a, const PlanarMove& a_to, const MapAnchor& b,
                      const PlanarMove& b_to) {
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : a.way) {
    for (const Eigen::Vector2d& q : b.way) least = std::min(least, (a_to(p) - b_to(q)).norm());
  }
  return least;
}

}  // namespace

AnchorStep step_between(const MapAnchor& from, const MapAnchor& to) {
  const Eigen::Vector2d way = (to.origin.position - from.origin.position).head<2>();
  Eigen::Matrix3d Q = added(from.covariance, way, to.covariance);
  Q.diagonal() += Eigen::Vector3d(kLeastPosition * kLeastPosition, kLeastPosition * kLeastPosition,
                                  kLeastYaw * kLeastYaw);
  return {move_of(from.origin).inverse() * to.jump * move_of(to.origin), turned(Q, -to.origin.yaw)};
}

namespace {

/// What an anchor has seen is drawn along a way that drifts: of its places as seen from its origin,
/// in the mean, in its frame. A walk's mean has a third of the variance of its end. Zero: it is
/// open.
Eigen::Matrix3d drawn_crooked(const AnchoredMap& map, int anchor) {
  const auto next = static_cast<std::size_t>(anchor) + 1;
  if (next >= map.anchors().size()) return Eigen::Matrix3d::Zero();
  const MapAnchor& to = map.anchors()[next];
  if (to.parent != anchor) return Eigen::Matrix3d::Zero();
  const AnchorStep step = step_between(map.anchors()[static_cast<std::size_t>(anchor)], to);
  return turned(step.covariance, step.way.yaw) / 3.0;
}

}  // namespace

std::size_t MapLoops::used() const {
  return static_cast<std::size_t>(
      std::count(graph_.loops().begin(), graph_.loops().end(), LoopState::kUsed));
}

PlanarMove MapLoops::place(int anchor) const {
  const auto T = graph_.pose(anchor);
  return T ? planar_move(*T) : PlanarMove{};
}

/// Of the place of sure_at_ as seen from an anchor, in W.
std::optional<Eigen::Matrix3d> MapLoops::sure(const AnchoredMap& map, int anchor) const {
  const auto covariance = graph_.covariance(anchor, sure_at_);
  if (!covariance) return std::nullopt;
  const Eigen::Vector3i planar(0, 1, 5);
  const MapAnchor& at = map.anchors()[static_cast<std::size_t>(sure_at_)];
  return turned((*covariance)(planar, planar), at.origin.yaw);
}

void MapLoops::extend(const AnchoredMap& map) {
  const std::vector<MapAnchor>& anchors = map.anchors();
  if (graph_.keyframes() == 0) (void)graph_.begin(0, in_space(move_of(anchors[0].origin)));
  while (graph_.keyframes() < anchors.size()) {
    const MapAnchor& to = anchors[graph_.keyframes()];
    const MapAnchor& from = anchors[static_cast<std::size_t>(to.parent)];
    (void)graph_.add_keyframe(to.id, from.id, relative(step_between(from, to)));
    if (aligns_) closed_.push_back(to.id - 1);
  }
}

void MapLoops::begin(const AnchoredMap& map, int anchor) {
  const double r = map.resolution();
  const MapAnchor& a = map.anchors()[static_cast<std::size_t>(anchor)];
  surfaces_.resize(static_cast<std::size_t>(anchor) + 1);
  SubmapSurface& surface = surfaces_.back();
  surface = SubmapSurface(a.evidence, r, map.table());
  anchor_ = anchor;
  walls_ = std::make_unique<NearestWall>(a.evidence, surface, r, map.table());
  others_.clear();
  const PlanarMove a_to = place(anchor) * move_of(a.origin).inverse();
  for (int n = 0; n < anchor; ++n) {
    const MapAnchor& b = map.anchors()[static_cast<std::size_t>(n)];
    if (b.evidence.empty()) continue;
    const PlanarMove b_to = place(n) * move_of(b.origin).inverse();
    if (least_distance(a, a_to, b, b_to) <= kReach) others_.push_back(n);
  }
}

void MapLoops::align_next(const AnchoredMap& map) {
  const int other = others_.front();
  others_.pop_front();
  const MapAnchor& a = map.anchors()[static_cast<std::size_t>(anchor_)];
  const MapAnchor& b = map.anchors()[static_cast<std::size_t>(other)];
  if (b.evidence.empty()) return;
  const PlanarMove a_at = move_of(a.origin), b_at = move_of(b.origin);
  const PlanarMove guess = a_at * place(anchor_).inverse() * place(other) * b_at.inverse();
  const auto covariance = graph_.covariance(other, anchor_);
  if (!covariance) return;
  const Eigen::Vector3i planar(0, 1, 5);
  const Eigen::Matrix3d spread = turned((*covariance)(planar, planar), a.origin.yaw);
  const Eigen::Vector2d centre = a.origin.position.head<2>();
  const auto found =
      align(surfaces_[static_cast<std::size_t>(other)], *walls_, guess, spread, centre);
  if (!found) return;
  Loop loop;
  loop.older = other;
  loop.newer = anchor_;
  loop.measured.way = (found->move * b_at).inverse() * a_at;
  loop.measured.covariance = turned(found->covariance, -a.origin.yaw) +
                             drawn_crooked(map, anchor_) +
                             turned(drawn_crooked(map, other), -loop.measured.way.yaw);
  loop.expected = {(guess * b_at).inverse() * a_at, turned(spread, -a.origin.yaw)};
  loop.overlap = found->overlap;
  loop.agreement = found->agreement;
  if (graph_.add_loop(other, anchor_, relative(loop.measured)) != GraphInput::kTaken) return;
  loops_.push_back(loop);
  optimise_ = true;
}

bool MapLoops::correct(AnchoredMap& map) {
  // The open anchor, and the robot with it, stays where it is in W.
  const MapAnchor& open = map.open();
  const PlanarMove origin = place(open.id) * move_of(open.origin).inverse();
  std::vector<PlanarMove> to_W;
  for (const MapAnchor& a : map.anchors()) {
    to_W.push_back(origin.inverse() * place(a.id) * move_of(a.origin).inverse());
  }
  to_W.pop_back();
  if (!map.is_worth(to_W)) return false;
  next_origin_ = origin;
  sure_.clear();
  sure_at_ = open.id;
  return map.follow(std::move(to_W));
}

bool MapLoops::move_robot(AnchoredMap& map, const Pose& robot, const Eigen::Matrix3d& covariance,
                          const Correction& correction) {
  if (told_ || map.follows()) return false;
  map.begin(robot, covariance, std::nullopt, planar_move(correction.T_new_old));
  told_ = correction;
  optimise_ = true;
  return true;
}

void MapLoops::merge(AnchoredMap& map) {
  for (; merged_ < loops_.size(); ++merged_) {
    const Loop& s = loops_[merged_];
    if (state(merged_) != LoopState::kUsed || s.overlap < kMostShared) continue;
    if (map.anchors()[static_cast<std::size_t>(s.older)].evidence.empty()) continue;
    map.merge(s.older, s.newer);
    surfaces_[static_cast<std::size_t>(s.older)] = {};
    const MapAnchor& newer = map.anchors()[static_cast<std::size_t>(s.newer)];
    surfaces_[static_cast<std::size_t>(s.newer)] =
        SubmapSurface(newer.evidence, map.resolution(), map.table());
  }
}

std::optional<MapLoops::Followed> MapLoops::go_on(AnchoredMap& map, double stamp) {
  extend(map);
  if (map.follows()) {
    for (int n = 0; n < kCovariances && static_cast<int>(sure_.size()) <= sure_at_; ++n) {
      const int anchor = static_cast<int>(sure_.size());
      sure_.push_back(anchor == sure_at_ ? Eigen::Matrix3d::Zero()
                                         : sure(map, anchor).value_or(Eigen::Matrix3d::Identity()));
    }
    if (static_cast<int>(sure_.size()) <= sure_at_) return std::nullopt;
    auto moved = map.go_on(kBricks, sure_);
    if (!moved) return std::nullopt;
    Followed done;
    done.moved = std::move(*moved);
    done.sure_at = sure_at_;
    done.covariance = sure_.front();
    if (told_) {
      done.correction = *std::exchange(told_, std::nullopt);
    } else {
      done.correction.kind = CorrectionKind::kAnchors;
      done.correction.why = formatted("places seen again: %zu of %zu loops", used(), found());
    }
    done.correction.stamp = stamp;
    done.correction.T_new_old = in_space(origin_.inverse() * next_origin_);
    origin_ = next_origin_;
    merge(map);
    return done;
  }
  if (!others_.empty()) {
    align_next(map);
  } else if (optimise_) {
    if (graph_.optimise({kIterations})) {
      optimise_ = false;
      if (!correct(map)) {
        told_.reset();
        merge(map);
      }
    }
  } else if (!closed_.empty()) {
    begin(map, closed_.front());
    closed_.pop_front();
  }
  return std::nullopt;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "perception/places/map_loops.h"

#include <Eigen/Eigenvalues>
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
constexpr int kMostAligned = 4;  // anchors, before the map follows in any case
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
  if (to.found) return {to.found->way, to.found->covariance};
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
  if (to.parent != anchor || to.found) return Eigen::Matrix3d::Zero();
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
  const int known = is_apart(map) ? map.first() : map.open().id + 1;
  while (static_cast<int>(graph_.keyframes()) < known) {
    const MapAnchor& to = anchors[graph_.keyframes()];
    const MapAnchor& from = anchors[static_cast<std::size_t>(to.parent)];
    (void)graph_.add_keyframe(to.id, from.id, relative(step_between(from, to)));
    if (aligns_ && !anchors[static_cast<std::size_t>(to.id - 1)].given)
      closed_.push_back(to.id - 1);
  }
}

void MapLoops::begin(const AnchoredMap& map, int anchor) {
  const MapAnchor& a = map.anchors()[static_cast<std::size_t>(anchor)];
  surfaces_.resize(static_cast<std::size_t>(anchor) + 1);
  surfaces_.back() = SubmapSurface(a.evidence, map.resolution(), map.table());
  anchor_ = anchor;
  walls_.reset();
  others_.clear();
  const PlanarMove a_to = place(anchor) * move_of(a.origin).inverse();
  for (int n = 0; n < anchor; ++n) {
    const MapAnchor& b = map.anchors()[static_cast<std::size_t>(n)];
    if (b.evidence.empty()) continue;
    const PlanarMove b_to = place(n) * move_of(b.origin).inverse();
    if (b.given || least_distance(a, a_to, b, b_to) <= kReach) others_.push_back(n);
  }
}

/// Of an older anchor, what lies near another one. to_anchor: from the other one's lattice to its.
SubmapSurface MapLoops::surface_near(const AnchoredMap& map, int anchor,
                                     const PlanarMove& to_anchor, const MapAnchor& other) const {
  const MapAnchor& a = map.anchors()[static_cast<std::size_t>(anchor)];
  if (!a.given) return surfaces_[static_cast<std::size_t>(anchor)];
  const Eigen::Vector2d at = to_anchor(Eigen::Vector2d(other.origin.position.head<2>()));
  return {a.evidence.around(at, kReach + AnchoredMap::kReach, map.resolution()), map.resolution(),
          map.table()};
}

void MapLoops::align_next(const AnchoredMap& map) {
  const MapAnchor& a = map.anchors()[static_cast<std::size_t>(anchor_)];
  if (!walls_) {
    walls_ = std::make_unique<NearestWall>(a.evidence, surfaces_[static_cast<std::size_t>(anchor_)],
                                           map.resolution(), map.table());
    return;
  }
  const int other = others_.front();
  others_.pop_front();
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
      align(surface_near(map, other, guess.inverse(), a), *walls_, guess, spread, centre);
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

/// Of all anchors but the open one: to_W, where W lies so in the frame of the first one.
std::vector<PlanarMove> MapLoops::places(const AnchoredMap& map, const PlanarMove& origin) const {
  std::vector<PlanarMove> to_W;
  for (const MapAnchor& a : map.anchors()) {
    to_W.push_back(origin.inverse() * place(a.id) * move_of(a.origin).inverse());
  }
  to_W.pop_back();
  return to_W;
}

bool MapLoops::correct(AnchoredMap& map) {
  // The open anchor, and the robot with it, stays where it is in W.
  const MapAnchor& open = map.open();
  const PlanarMove origin = place(open.id) * move_of(open.origin).inverse();
  std::vector<PlanarMove> to_W = places(map, origin);
  if (!joins_ && !map.is_worth(to_W)) return false;
  next_origin_ = origin;
  sure_.clear();
  sure_at_ = open.id;
  return map.follow(std::move(to_W));
}

bool MapLoops::move_robot(AnchoredMap& map, const Pose& robot, const Eigen::Matrix3d& covariance,
                          const Correction& correction) {
  if (told_ || map.follows() || map.first() > 0) return false;
  map.begin(robot, covariance, std::nullopt, planar_move(correction.T_new_old));
  told_ = correction;
  optimise_ = true;
  return true;
}

void MapLoops::merge(AnchoredMap& map) {
  for (; merged_ < loops_.size(); ++merged_) {
    const Loop& s = loops_[merged_];
    if (state(merged_) != LoopState::kUsed || s.overlap < kMostShared) continue;
    const MapAnchor& older = map.anchors()[static_cast<std::size_t>(s.older)];
    if (older.evidence.empty() || older.given) continue;
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
    } else if (std::exchange(joins_, false)) {
      done.correction.kind = CorrectionKind::kAnchors;
      done.correction.why = "the place in the map was found";
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
  if (is_apart(map)) {
    seek(map);
  } else if (!others_.empty()) {
    align_next(map);
  } else if (optimise_ && (closed_.empty() || aligned_ >= kMostAligned || told_ || joins_)) {
    if (graph_.optimise({kIterations})) {
      optimise_ = false;
      aligned_ = 0;
      if (!correct(map)) {
        told_.reset();
        merge(map);
      }
    }
  } else if (!closed_.empty()) {
    begin(map, closed_.front());
    closed_.pop_front();
    ++aligned_;
  }
  return std::nullopt;
}

void MapLoops::lift(AnchoredMap& map, const Pose& robot, const Eigen::Matrix3d& covariance) {
  extend(map);
  told_.reset();
  sure_.clear();
  others_.clear();
  joins_ = optimise_ = false;
  search_.reset();
  map.begin_apart(robot, covariance);
  raster_ = {};
  rastered_ = 0;
  searched_ = map.first() - 1;
  seeking_ = "the place in the map is not known";
}

/// From an anchor's lattice to where the first one stays.
PlanarMove MapLoops::to_start(const AnchoredMap& map, int anchor) const {
  return place(anchor) * move_of(map.anchors()[static_cast<std::size_t>(anchor)].origin).inverse();
}

void MapLoops::seek(AnchoredMap& map) {
  constexpr long kLookups = 500'000;
  extend(map);
  const double r = map.resolution();
  surfaces_.resize(std::max(surfaces_.size(), map.anchors().size()));
  if (rastered_ < map.first()) {
    const MapAnchor& a = map.anchors()[static_cast<std::size_t>(rastered_)];
    SubmapSurface& surface = surfaces_[static_cast<std::size_t>(rastered_)];
    if (surface.walls().empty()) surface = SubmapSurface(a.evidence, r, map.table());
    raster_.add(a.evidence, surface, to_start(map, rastered_), r, map.table());
    if (++rastered_ == map.first()) raster_.build();
    return;
  }
  if (!search_) {
    if (map.open().id - 1 > searched_) begin_search(map);
    return;
  }
  const PlaceSearch::State state = search_->go_on(kLookups);
  if (state == PlaceSearch::State::kSearching) return;
  const std::unique_ptr<PlaceSearch> done = std::move(search_);
  if (state == PlaceSearch::State::kUnique && join(map, done->places().front().move)) {
    seeking_.clear();
  } else if (state == PlaceSearch::State::kAmbiguous) {
    seeking_ = formatted("the place in the map is not known: what was seen fits at %zu places",
                         done->places().size());
  } else {
    seeking_ = "the place in the map is not known: what was seen fits nowhere in it";
  }
}

void MapLoops::begin_search(const AnchoredMap& map) {
  searched_ = map.open().id - 1;
  const double r = map.resolution();
  std::vector<SubmapSurface::Wall> walls;
  PlaceRaster seen;
  for (int n = map.first(); n <= searched_; ++n) {
    SubmapSurface& surface = surfaces_[static_cast<std::size_t>(n)];
    const MapEvidence& evidence = map.anchors()[static_cast<std::size_t>(n)].evidence;
    if (surface.walls().empty()) surface = SubmapSurface(evidence, r, map.table());
    seen.add(evidence, surface, {}, r, map.table());
    walls.insert(walls.end(), surface.walls().begin(), surface.walls().end());
  }
  seen.build();
  search_ = std::make_unique<PlaceSearch>(raster_, walls, seen.free(),
                                          map.open().origin.position.head<2>());
}

/// Where it was found: from the lattices of what was drawn apart, W, to where the first one stays.
/// The walls of the newest anchor that was searched with decide.
bool MapLoops::join(AnchoredMap& map, const PlanarMove& found) {
  constexpr double kShift = 0.3, kTurn = 0.05;           // deviation of what the search finds
  constexpr double kSureShift = 0.15, kSureTurn = 0.05;  // at which it is decided
  constexpr double kLeastAgreement = 0.75;
  const MapAnchor& newest = map.anchors()[static_cast<std::size_t>(searched_)];
  const SubmapSurface& surface = surfaces_[static_cast<std::size_t>(searched_)];
  const NearestWall walls(newest.evidence, surface, map.resolution(), map.table());
  const Eigen::Matrix3d spread =
      Eigen::Vector3d(kShift * kShift, kShift * kShift, kTurn * kTurn).asDiagonal();
  const Eigen::Vector2d centre = newest.origin.position.head<2>();
  std::optional<SubmapAlignment> best;
  int parent = -1;
  for (int n = 0; n < map.first(); ++n) {
    const MapAnchor& older = map.anchors()[static_cast<std::size_t>(n)];
    if (older.evidence.empty()) continue;
    if (!older.given && least_distance(newest, found, older, to_start(map, n)) > kReach) continue;
    const PlanarMove guess = found.inverse() * to_start(map, n);
    const auto at =
        align(surface_near(map, n, guess.inverse(), newest), walls, guess, spread, centre);
    if (!at || at->agreement < kLeastAgreement) continue;
    if (!best || at->matched > best->matched) best = at, parent = n;
  }
  if (!best) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      best->covariance.topLeftCorner<2, 2>());
  if (eigen.eigenvalues()[1] > kSureShift * kSureShift ||
      best->covariance(2, 2) > kSureTurn * kSureTurn) {
    return false;
  }
  // From there to the first anchor that was drawn apart by odometry.
  const MapAnchor& from = map.anchors()[static_cast<std::size_t>(parent)];
  const MapAnchor& first = map.anchors()[static_cast<std::size_t>(map.first())];
  const Eigen::Vector2d way = (newest.origin.position - first.origin.position).head<2>();
  const Eigen::Matrix3d there =
      carried(best->covariance, -way) + added(first.covariance, way, newest.covariance);
  MapAnchor::Found step;
  step.way = (best->move * move_of(from.origin)).inverse() * move_of(first.origin);
  step.covariance = turned(there, -first.origin.yaw);
  map.found(map.first(), parent, step);
  joins_ = optimise_ = true;
  return true;
}

bool MapLoops::is_busy(const AnchoredMap& map) const {
  if (is_apart(map)) {
    return search_ || rastered_ < map.first() || searched_ < map.open().id - 1;
  }
  return map.follows() || optimise_ || !others_.empty() || !closed_.empty() ||
         graph_.keyframes() < map.anchors().size();
}

void MapLoops::finish(AnchoredMap& map, double stamp) {
  while (is_busy(map)) go_on(map, stamp);
  if (is_apart(map)) return;
  std::vector<PlanarMove> to_start = places(map, {});
  origin_ = {};
  if (!map.is_worth(to_start) || !map.follow(std::move(to_start))) return;
  while (!map.go_on(kBricks)) {
  }
}

}  // namespace prospect

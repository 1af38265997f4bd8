// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/straight_map.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#ifdef PROSPECT_LOOPS
#include "engine/maps/planar_error.h"
#include "perception/mapping/anchored_map.h"
#include "perception/places/map_loops.h"

namespace prospect {

struct StraightMap::Impl {
  AnchoredMap map;
  MapLoops loops;
  Robot last;         // at the newest scan
  double way = 0.0;   // [m] since the anchor began
  Eigen::Matrix3d S;  // at the origin of the anchor `sure_at`, from the start
  int sure_at = -1;   // -1: as odometry says

  Impl(std::shared_ptr<OccupancyMapper> mapper, const Pose& start, bool aligns)
      : map(std::move(mapper), start), loops(aligns), last{start, {}} {}
};

StraightMap::StraightMap(std::shared_ptr<OccupancyMapper> map, const Pose& start, bool aligns)
    : impl_(std::make_unique<Impl>(std::move(map), start, aligns)) {}
StraightMap::~StraightMap() = default;
bool StraightMap::is_built_in() { return true; }

void StraightMap::begin_anchor(const Robot& robot, std::optional<int> parent) {
  impl_->map.begin(robot.pose, robot.covariance, parent);
  impl_->last = robot;
  impl_->way = 0.0;
}

int StraightMap::open_anchor() const { return impl_->map.open().id; }

void StraightMap::give(const Robot& robot, bool place_known) {
  impl_->map.give();
  place_known ? begin_anchor(robot) : lift(robot);
}

void StraightMap::lift(const Robot& robot) {
  Impl& s = *impl_;
  s.loops.lift(s.map, robot.pose, robot.covariance);
  s.last = robot;
  s.way = 0.0;
  s.S.setZero();
  s.sure_at = open_anchor();
}

const std::string& StraightMap::seeking() const { return impl_->loops.seeking(); }

std::optional<StraightMap::Followed> StraightMap::go_on(double stamp, const Robot& robot) {
  constexpr double kAnchorWay = 2.5, kMetresPerRadian = 0.3;  // [m], [m/rad]
  Impl& s = *impl_;
  s.way += (robot.pose.position - s.last.pose.position).head<2>().norm() +
           kMetresPerRadian * std::abs(robot.pose.yaw - s.last.pose.yaw);
  s.last = robot;
  if (s.way >= kAnchorWay) begin_anchor(robot);
  s.map.note(robot.pose);
  auto done = s.loops.go_on(s.map, stamp);
  if (!done) return std::nullopt;
  s.S = done->covariance;
  s.sure_at = done->sure_at;
  return Followed{{std::move(done->correction), std::move(done->moved.places)},
                  std::move(done->moved.anchors)};
}

bool StraightMap::move_robot(const Robot& robot, const Correction& correction) {
  if (!impl_->loops.move_robot(impl_->map, robot.pose, robot.covariance, correction)) return false;
  impl_->last = robot;
  impl_->way = 0.0;
  return true;
}

void StraightMap::finish(double stamp) {
  begin_anchor(Robot(impl_->last));
  impl_->loops.finish(impl_->map, stamp);
}

Eigen::Matrix3d StraightMap::covariance(const Robot& robot) const {
  if (impl_->sure_at < 0) return robot.covariance;
  const MapAnchor& at = impl_->map.anchors()[static_cast<std::size_t>(impl_->sure_at)];
  const Eigen::Vector2d way = (robot.pose.position - at.origin.position).head<2>();
  const Eigen::Matrix3d P = carried(impl_->S, way) + added(at.covariance, way, robot.covariance);
  return 0.5 * (P + P.transpose());
}

PlanarMove StraightMap::origin() const { return impl_->loops.origin(); }
PlanarMove StraightMap::moved(int anchor) const {
  return impl_->map.anchors()[static_cast<std::size_t>(anchor)].to_W;
}
int StraightMap::used() const { return static_cast<int>(impl_->loops.used()); }
int StraightMap::found() const { return static_cast<int>(impl_->loops.found()); }
const AnchoredMap& StraightMap::anchored() const { return impl_->map; }
const MapLoops& StraightMap::loops() const { return impl_->loops; }

}  // namespace prospect

#else

namespace prospect {

struct StraightMap::Impl {};

StraightMap::StraightMap(std::shared_ptr<OccupancyMapper>, const Pose&, bool) {
  throw std::invalid_argument(
      "a map that is kept straight needs Ceres, without which this was built");
}
StraightMap::~StraightMap() = default;
bool StraightMap::is_built_in() { return false; }
void StraightMap::begin_anchor(const Robot&, std::optional<int>) {}
int StraightMap::open_anchor() const { return 0; }
void StraightMap::give(const Robot&, bool) {}
void StraightMap::lift(const Robot&) {}
const std::string& StraightMap::seeking() const {
  static const std::string kNot;
  return kNot;
}
std::optional<StraightMap::Followed> StraightMap::go_on(double, const Robot&) { return {}; }
bool StraightMap::move_robot(const Robot&, const Correction&) { return false; }
void StraightMap::finish(double) {}
Eigen::Matrix3d StraightMap::covariance(const Robot& robot) const { return robot.covariance; }
PlanarMove StraightMap::origin() const { return {}; }
PlanarMove StraightMap::moved(int) const { return {}; }
int StraightMap::used() const { return 0; }
int StraightMap::found() const { return 0; }

}  // namespace prospect

#endif

namespace prospect {

std::optional<StraightMap::Followed> go_on(StraightMap& map, double stamp,
                                           const StraightMap::Robot& robot,
                                           Corrections& corrections) {
  auto done = map.go_on(stamp, robot);
  if (done) {
    corrections.followed(done->correction.correction, robot.pose, done->correction.moves);
  }
  if (!map.seeking().empty()) corrections.cannot(map.seeking());
  return done;
}

Corrections::Answer correct(const Correction& correction, const StraightMap::Robot& robot,
                            Corrections& corrections, StraightMap* map) {
  if (correction.kind == CorrectionKind::kRobot && map != nullptr) {
    std::string why = corrections.refuse(correction, robot.pose);
    if (!why.empty()) return {CorrectionVerdict::kRefused, std::move(why)};
    if (map->move_robot(robot, correction)) return {};
  }
  return corrections.take(correction, robot.pose);
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/straight_map.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#ifdef PROSPECT_LOOPS
#include "engine/maps/planar_error.h"
#include "perception/mapping/anchored_map.h"
#include "perception/places/map_loops.h"

namespace prospect {

struct StraightMap::Impl {
  AnchoredMap map;
  MapLoops loops;
  Pose last;          // of the robot at the newest scan
  double way = 0.0;   // [m] since the anchor began
  Eigen::Matrix3d S;  // at the origin of the anchor `sure_at`, from the start
  int sure_at = -1;   // -1: as odometry says

  Impl(std::shared_ptr<OccupancyMapper> mapper, const Pose& start, bool aligns)
      : map(std::move(mapper), start), loops(aligns), last(start) {}
};

StraightMap::StraightMap(std::shared_ptr<OccupancyMapper> map, const Pose& start, bool aligns)
    : impl_(std::make_unique<Impl>(std::move(map), start, aligns)) {}
StraightMap::~StraightMap() = default;

void StraightMap::begin_anchor(const Robot& robot, std::optional<int> parent) {
  impl_->map.begin(robot.pose, robot.covariance, parent);
  impl_->last = robot.pose;
  impl_->way = 0.0;
}

int StraightMap::open_anchor() const { return impl_->map.open().id; }

std::optional<StraightMap::Followed> StraightMap::go_on(double stamp, const Robot& robot) {
  constexpr double kAnchorWay = 2.5, kMetresPerRadian = 0.3;  // [m], [m/rad]
  Impl& s = *impl_;
  s.way += (robot.pose.position - s.last.position).head<2>().norm() +
           kMetresPerRadian * std::abs(robot.pose.yaw - s.last.yaw);
  s.last = robot.pose;
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
  impl_->last = robot.pose;
  impl_->way = 0.0;
  return true;
}

Eigen::Matrix3d StraightMap::covariance(const Robot& robot) const {
  if (impl_->sure_at < 0) return robot.covariance;
  const MapAnchor& at = impl_->map.anchors()[static_cast<std::size_t>(impl_->sure_at)];
  const Eigen::Vector2d way = (robot.pose.position - at.origin.position).head<2>();
  const Eigen::Matrix3d P = carried(impl_->S, way) + added(at.covariance, way, robot.covariance);
  return 0.5 * (P + P.transpose());
}

PlanarMove StraightMap::origin() const { return impl_->loops.origin(); }
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
void StraightMap::begin_anchor(const Robot&, std::optional<int>) {}
int StraightMap::open_anchor() const { return 0; }
std::optional<StraightMap::Followed> StraightMap::go_on(double, const Robot&) { return {}; }
bool StraightMap::move_robot(const Robot&, const Correction&) { return false; }
Eigen::Matrix3d StraightMap::covariance(const Robot& robot) const { return robot.covariance; }
PlanarMove StraightMap::origin() const { return {}; }

}  // namespace prospect

#endif

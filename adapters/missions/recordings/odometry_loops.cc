// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_loops.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#ifdef PROSPECT_LOOPS

#include "engine/support/stopwatch.h"
#include "perception/places/view_loops.h"

namespace prospect {

struct OdometryLoops::Impl {
  explicit Impl(const StereoCamera& camera) : loops(camera) {}

  /// Of a frame: the newest view then, and the pose in it.
  struct Seen {
    double stamp;
    int view;
    Eigen::Isometry3d T_VC;
  };

  ViewLoops loops;
  std::vector<Seen> seen;
  std::vector<double> stamps;  // of the views
  Trajectory online;
  std::vector<double> milliseconds;
};

OdometryLoops::OdometryLoops(const StereoCamera& camera) : impl_(std::make_unique<Impl>(camera)) {}
OdometryLoops::~OdometryLoops() = default;
OdometryLoops::OdometryLoops(OdometryLoops&&) noexcept = default;

void OdometryLoops::add(const OdometryStep& step) {
  const OdometryFrame& frame = step.frame;
  if (frame.state == Localization::kLost) return;
  ViewLoops& loops = impl_->loops;
  if (frame.keyframe) {
    const int before = loops.views();
    ProcessorStopwatch watch;
    loops.keyframe(frame, step.images.left.view(), step.images.right.view());
    if (loops.views() > before) {
      impl_->milliseconds.push_back(watch.lap());
      impl_->stamps.push_back(frame.stamp);
    }
  }
  if (loops.views() == 0) return;
  const int view = loops.views() - 1;
  impl_->seen.push_back({frame.stamp, view, loops.measured(view).inverse() * frame.T_WC});
  impl_->online.push_back({frame.stamp, loops.corrected(frame.T_WC)});
}

OdometryLoopsResult OdometryLoops::result() {
  ViewLoops& loops = impl_->loops;
  loops.settle();
  OdometryLoopsResult result;
  result.views = loops.views();
  result.found = static_cast<int>(loops.loops().size());
  result.used = static_cast<int>(loops.used());
  result.online = impl_->online;
  for (std::size_t n = 0; n < loops.loops().size(); ++n) {
    if (loops.state(n) != LoopState::kUsed) continue;
    const ViewLoops::Loop& loop = loops.loops()[n];
    result.loops.push_back({impl_->stamps[static_cast<std::size_t>(loop.older)],
                            impl_->stamps[static_cast<std::size_t>(loop.newer)],
                            loops.pose(loop.older).translation(),
                            loops.pose(loop.newer).translation()});
  }
  for (const Impl::Seen& s : impl_->seen) {
    const Eigen::Isometry3d T_WC = loops.pose(s.view) * s.T_VC;
    const Eigen::Isometry3d measured = loops.measured(s.view) * s.T_VC;
    result.farthest =
        std::max(result.farthest, (T_WC.translation() - measured.translation()).norm());
    result.final.push_back({s.stamp, T_WC});
  }
  result.processor = percentiles(impl_->milliseconds);
  return result;
}

}  // namespace prospect

#else

namespace prospect {

struct OdometryLoops::Impl {};
OdometryLoops::OdometryLoops(const StereoCamera&) {
  throw std::invalid_argument("loops need Ceres, without which this was built");
}
OdometryLoops::~OdometryLoops() = default;
OdometryLoops::OdometryLoops(OdometryLoops&&) noexcept = default;
void OdometryLoops::add(const OdometryStep&) {}
OdometryLoopsResult OdometryLoops::result() { return {}; }

}  // namespace prospect

#endif

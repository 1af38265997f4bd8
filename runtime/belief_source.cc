// SPDX-License-Identifier: Apache-2.0
#include "runtime/belief_source.h"

namespace prospect {

std::shared_ptr<const Belief> PipelineBeliefs::update(const std::stop_token& stop) {
  constexpr double kWait = 0.1;  // [s]
  constexpr int kAtOnce = 32;    // so that who delivers without end does not keep a belief back
  if (!inbox_.wait(kWait, stop)) return nullptr;
  bool any = false;
  for (int k = 0; k < kAtOnce; ++k) {
    const std::optional<SensorFrame> frame = inbox_.take();
    if (!frame) break;
    tell(observers_, &MissionObserver::on_frame, *frame);
    if (const auto* pair = std::get_if<StereoFrame>(&*frame)) left_ = pair->left;
    feed(perception_, *frame);
    any = true;
  }
  return any ? perception_.belief() : nullptr;
}

CameraPicture PipelineBeliefs::picture() {
  if (!left_) return {};
  return {std::exchange(left_, nullptr), perception_.sightings()};
}

}  // namespace prospect

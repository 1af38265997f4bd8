#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <utility>

#include "engine/maps/belief.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// What a perception thread runs: it turns what sensors deliver into beliefs. One thread; the
/// beliefs may be read anywhere. Does not throw.
class BeliefSource {
 public:
  virtual ~BeliefSource() = default;
  /// Waits for new input, for a tenth of a second at most and not after `stop`, works it in and
  /// gives what is known then; null: nothing came. Stamps are in the runtime's clock.
  virtual std::shared_ptr<const Belief> update(const std::stop_token& stop) = 0;
};

/// What comes through an inbox, by a perception pipeline; both outlive it.
class PipelineBeliefs final : public BeliefSource {
 public:
  /// on_frame: each frame before perception takes it, on the thread of update(); must not throw.
  /// May be empty.
  PipelineBeliefs(SensorInbox& inbox, PerceptionPipeline& perception,
                  std::function<void(const SensorFrame&)> on_frame = {})
      : inbox_(inbox), perception_(perception), on_frame_(std::move(on_frame)) {}
  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;

 private:
  SensorInbox& inbox_;
  PerceptionPipeline& perception_;
  std::function<void(const SensorFrame&)> on_frame_;
};

}  // namespace prospect

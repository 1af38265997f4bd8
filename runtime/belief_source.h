// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/belief.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/camera_picture.h"
#include "runtime/mission_observer.h"
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
  /// What is known, once no thread asks any more; null: nobody says.
  virtual std::shared_ptr<const Belief> known() { return nullptr; }
  /// Why it cannot be trusted; empty: nothing is known against it.
  virtual std::string complaint() const { return {}; }
  /// What the cameras showed for the newest belief; without an image: nothing new.
  virtual CameraPicture picture() { return {}; }
  /// Who is told of frames before perception takes them, on the thread of update(). They outlive
  /// it.
  void watched_by(std::vector<MissionObserver*> observers) { observers_ = std::move(observers); }

 protected:
  std::vector<MissionObserver*> observers_;
};

/// What comes through an inbox, by a perception pipeline; both outlive it.
class PipelineBeliefs final : public BeliefSource {
 public:
  PipelineBeliefs(SensorInbox& inbox, PerceptionPipeline& perception)
      : inbox_(inbox), perception_(perception) {}
  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;
  std::shared_ptr<const Belief> known() override { return perception_.belief(); }
  std::string complaint() const override { return perception_.complaint(); }
  CameraPicture picture() override;

 private:
  SensorInbox& inbox_;
  PerceptionPipeline& perception_;
  std::shared_ptr<const Image> left_;  // newest that was not told of
};

}  // namespace prospect

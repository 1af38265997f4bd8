// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/run_observer.h"
#include "adapters/missions/run/run_record.h"
#include "runtime/mission.h"
#include "runtime/truth.h"

namespace prospect {

/// Turns what a mission tells of each planning step into records, whatever drives the robot: one of
/// its observers (MissionOptions), who tells others of the records, and sums up at the end. What is
/// not known to be true is NaN. Thread-safety: as MissionObserver. on_step() throws what
/// RunObserver::on_record() does.
class RunRecorder final : public MissionObserver {
 public:
  /// keep_steps: every StepRecord, with pictures, for the report. The configuration outlives it.
  /// Throws InputError if steps are kept and the codecs of their pictures cannot be loaded.
  explicit RunRecorder(const Configuration& configuration, std::uint64_t seed = 1,
                       bool keep_steps = true);
  ~RunRecorder() override;
  /// Who is told of the records. They outlive it.
  void watched_by(std::vector<RunObserver*> observers);

  void on_picture(const CameraPicture& picture) override;
  void on_step(const MissionStep& step) override;
  /// Once, at the end. truth, reachable: null: nobody knows.
  RunRecord finish(const MissionResult& mission, const std::string& world, const Truth* truth,
                   const ReachableArea* reachable);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect

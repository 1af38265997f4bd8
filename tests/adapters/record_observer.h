// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "adapters/missions/run/run_observer.h"

namespace prospect::test {

/// Calls a function with each record of a mission, which it watches alone.
class RecordObserver final : public RunObserver {
 public:
  explicit RecordObserver(std::function<void(const StepRecord&)> function)
      : function_(std::move(function)) {}
  void on_record(const StepRecord& record, const MissionStep&) override { function_(record); }
  /// As ExplorationRunOptions::observers.
  template <class Configuration>
  std::vector<RunObserver*> operator()(const Configuration&) {
    return {this};
  }

 private:
  std::function<void(const StepRecord&)> function_;
};

}  // namespace prospect::test

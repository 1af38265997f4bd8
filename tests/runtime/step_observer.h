// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>

#include "runtime/mission.h"

namespace prospect::test {

/// Calls a function at each step of a mission; empty: none.
class StepObserver final : public MissionObserver {
 public:
  using Function = std::function<void(const MissionStep&)>;
  explicit StepObserver(Function function) : function_(std::move(function)) {}
  void on_step(const MissionStep& step) override {
    if (function_) function_(step);
  }

 private:
  Function function_;
};

}  // namespace prospect::test

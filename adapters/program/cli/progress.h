// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "adapters/views/report/progress_line.h"

namespace prospect {

/// What a command that takes long says on standard error while it does: one ProgressLine, which is
/// ended when this object is, or finish() is called. Nothing if `quiet`, or if that is no terminal.
class Progress {
 public:
  explicit Progress(bool quiet = false) : quiet_(quiet) {}
  ~Progress() { line_.finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& text) {
    if (!quiet_) line_.show(text, seconds());
  }
  void show(const StepRecord& step, const std::string& solver) {
    if (!quiet_) line_.show(step, solver, seconds());
  }
  void finish() { line_.finish(); }

 private:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  ProgressLine line_ = ProgressLine::on_stderr();
  bool quiet_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace prospect

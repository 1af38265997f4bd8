// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <memory>
#include <string>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// One line on a terminal that follows a mission, or something else that takes long, rewritten in
/// place at most ten times a second. Of a mission:
///
///   42.5 s   63.2 %  ████████████▋         31.4 m   error 0.08 m   87 features   explore  → target
///   3.2 m   ipopt  41 ms
///
/// time, coverage, path, localization error, features tracked now, mode, way left to the target,
/// back end, planning time: as many of them, from the left, as fit; a dash where there is no
/// number. Not on a terminal it writes nothing at all, so logs and pipes stay clean. Colour (a
/// warning tint where localization is not ok, the robot retreats or the plan is a stopping tail)
/// only where asked for. Takes its clock as an argument. Not thread-safe.
class ProgressLine {
 public:
  struct Terminal {
    bool tty = false;    ///< whether it is one
    bool color = false;  ///< whether colour is asked for
    int columns = 100;   ///< its width; the line is cut to one less, as one that wraps stays
  };
  /// The stream outlives this object. Of texts that are shown no control character reaches it.
  ProgressLine(std::ostream& out, const Terminal& terminal);
  /// On stderr as it is: a terminal or not, its width, and NO_COLOR (any non-empty value turns
  /// colour off, see no-color.org) and TERM=dumb from the environment.
  static ProgressLine on_stderr();

  /// The line of a mission. `now_seconds`: any monotonic clock.
  void show(const StepRecord& step, const std::string& solver, double now_seconds);
  /// Any other line, of one column a byte; what does not fit is cut.
  void show(const std::string& text, double now_seconds);
  /// Writes the newest line if the rate held it back, and ends it, so that what follows starts on
  /// a line of its own. Harmless if nothing was shown; idempotent.
  void finish();

 private:
  void put(const std::string& line, double now_seconds);
  void write(const std::string& line);

  std::shared_ptr<std::ostream> own_;  ///< of on_stderr()
  std::ostream* out_;
  Terminal terminal_;
  bool shown_ = false;
  double last_ = 0.0;
  std::string held_back_;
};

}  // namespace prospect

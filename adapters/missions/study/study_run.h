// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adapters/missions/study/cell_store.h"
#include "adapters/missions/study/study_plan.h"

namespace prospect {

/// A part of a study: those cells whose hash says so, for one of several workers.
struct StudyShard {
  int number = 1, of = 1;  ///< 1 to `of`
};

/// Names of the cells of a shard, each once, in the order of the plan.
std::vector<std::string> cells_of(const StudyPlan& plan, const StudyShard& shard);

/// How long cells are expected to take [s], from those that ran.
class ExpectedTimes {
 public:
  /// The plan must outlive it.
  explicit ExpectedTimes(const StudyPlan& plan);
  void add(const std::string& id, double wall_s);
  /// The mean of the cells with the same input and setup; else with that input; else of all; NaN:
  /// no cell ran.
  double of(const std::string& id) const;

 private:
  struct Mean {
    double sum = 0.0;
    int count = 0;
  };

  std::map<std::string, const StudyCell*> cells_;
  std::map<std::pair<std::size_t, std::size_t>, Mean> alike_;  ///< by input and setup
  std::map<std::size_t, Mean> of_input_;
  Mean all_;
};

struct StudyProgress {
  std::size_t done = 0, failed = 0, cells = 0, running = 0;  ///< of the shard
  double left_s = 0.0;  ///< [s] expected; NaN: nothing has run yet
};

struct StudyRunOptions {
  StudyShard shard;
  int jobs = 1;
  bool retry_failed = false;
  std::vector<std::string> program;  ///< words that start `prospect`; arguments follow
  std::vector<std::string> plugins;  ///< that it is to load
  std::string version;               ///< for records
  std::function<bool()> cancelled;
  std::function<void(const StudyProgress&)> progress;  ///< about ten times a second
  /// After each cell that was run here.
  std::function<void(const StudyCell&, const CellRecord&)> ended;
};

struct StudyRunResult {
  std::size_t cells = 0;       ///< of the shard
  std::size_t there = 0;       ///< that were done before
  std::size_t ran = 0;         ///< done now
  std::size_t failed = 0;      ///< now or before
  std::size_t elsewhere = 0;   ///< that another process runs
  std::size_t broken_off = 0;  ///< begun here, and ended by a signal from outside
  bool cancelled = false;
  /// Not of a cell but of this machine, such as a full disk: nothing more was begun.
  std::string stopped;
};

/// Runs what is not there yet, each cell by a process of its own, `jobs` at a time: one that
/// crashes is a failed cell. A cell that another process runs is left to it. When cancelled,
/// running cells are killed; they are run again the next time. Throws InputError where the store
/// cannot be written.
StudyRunResult run_study(const StudyPlan& plan, const CellStore& store,
                         const StudyRunOptions& options);

}  // namespace prospect

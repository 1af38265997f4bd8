// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/files/row_file.h"
#include "adapters/missions/run/run_observer.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/missions/run/run_start.h"
#include "adapters/missions/run/step_row.h"
#include "adapters/missions/run/summary.h"

namespace octomap {
class OcTree;
}

namespace prospect {

struct SavedProblem;

/// The folder that a mission writes (docs/reference/report.md describes every file and column):
///   config.yaml, run.json       what it was started with, from the first second
///   steps.csv                   one row a planning step; the same bytes for the same seed
///   timing.csv                  wall-clock milliseconds of each step, kept apart for that reason
///   trajectory_estimated.tum, trajectory_true.tum
///   problems/step_000040.h5     the problem of a planning step, if asked for
///   summary.json, map.bt, report.html     at the end
///
/// Rows are handed to the operating system one by one, so a kill at any moment leaves whole rows
/// only (see RowFile); the files at the end appear whole or not at all, summary.json last. The
/// first write that fails (disk full, say) is remembered in error(); writing goes on where it can,
/// and nothing throws after construction. One run at a time: the folder is an OutputFolder, locked
/// until this object is gone. If that is before the first step, and without finish(), nothing of it
/// is left. Not thread-safe.
class RunFolder final : public RunObserver {
 public:
  /// What becomes of a drive that the folder holds: it happened once, and is in no other place.
  enum class EarlierDrive { kRefused, kReplaced };

  /// Creates the folder. An existing folder is taken only if it is empty or that of a run, whose
  /// files are then replaced. Throws InputError otherwise, and where another run writes to it,
  /// before anything is written; and where config.yaml or run.json cannot be written.
  RunFolder(const std::string& path, const RunStart& start,
            EarlierDrive earlier = EarlierDrive::kRefused);
  ~RunFolder() override;
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// A further file of the run, as its own (OutputFolder::claim()); its path.
  std::string claim(const std::string& name) { return folder_.claim(name); }
  /// The columns of steps.csv are the terms of the first step that has any; rows before it wait
  /// for them. A term that first appears later has no column.
  void add(const StepRecord& step);
  void on_record(const StepRecord& record, const MissionStep&) override { add(record); }
  /// Writes the problem file of a planning step (saved.origin.step), whole or not at all.
  void add(const SavedProblem& saved);
  /// The page of a run, report.html.
  using Page = std::function<std::string(const RunRecord&)>;
  /// Everything that is written at the end. `map` may be null.
  void finish(const RunRecord& record, const octomap::OcTree* map, const Page& page);

  const std::string& path() const { return path_; }
  /// Empty, or what went wrong first, in one line.
  const std::string& error() const { return error_; }

 private:
  void begin(const RunStart& start);
  void write_waiting();
  void append(RowFile& file, const char* name, const std::string& row);
  void fail(const std::string& name, const std::string& reason);
  /// Writes a temporary file beside it, then renames.
  void write_whole(const std::string& name, const std::string& content);

  std::string path_;
  std::string error_;
  OutputFolder folder_;
  bool holds_steps_ = false;         // or what there is at the end
  StepColumns columns_;              // from the first step that has a plan
  std::vector<StepRecord> waiting_;  // rows before the columns are known
  bool header_written_ = false;
  RowFile steps_, timing_, estimated_, true_;
};

}  // namespace prospect

#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "adapters/run/run_record.h"

namespace octomap {
class OcTree;
}

namespace prospect {

/// The folder that a mission writes:
///   steps.csv                   one row a planning step; the same bytes for the same seed
///   timing.csv                  wall-clock milliseconds of each step, kept apart for that reason
///   trajectory_estimated.tum, trajectory_true.tum
///   summary.json, config.yaml, map.bt, report.html     at the end
///
/// Rows are flushed one by one, so a kill at any moment leaves every whole row readable; the files
/// at the end appear whole or not at all. The first write that fails (disk full, say) is remembered
/// in error(); writing goes on where it can, and nothing throws after construction.
class RunFolder {
 public:
  /// Creates the folder. An existing folder is taken only if it is empty or holds a run
  /// (steps.csv), whose files are then replaced. Throws InputError otherwise, before anything is
  /// written.
  explicit RunFolder(const std::string& path);

  void add(const StepRecord& step);
  /// Everything that is written at the end. `map` may be null.
  void finish(const RunRecord& record, const octomap::OcTree* map);

  const std::string& path() const { return path_; }
  /// Empty, or what went wrong first, in one line.
  const std::string& error() const { return error_; }

 private:
  void write_waiting();
  void write_row(const StepRecord& step);
  void check(std::ofstream& file, const std::string& name);
  /// Writes a temporary file beside it, then renames.
  void write_whole(const std::string& name, const std::string& content);

  std::string path_;
  std::string error_;
  std::vector<std::string> terms_;   // columns, from the first step that has a plan
  std::vector<StepRecord> waiting_;  // rows before the columns are known
  bool header_written_ = false;
  std::ofstream steps_, timing_, estimated_, true_;
};

/// summary.json.
std::string summary_json(const Summary& summary);

}  // namespace prospect

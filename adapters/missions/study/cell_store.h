// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/study/study.h"

namespace prospect {

/// What is known of a cell besides its folder.
struct CellRecord {
  enum class Status {
    kMissing,  ///< never begun, or broken off
    kDone,     ///< its folder is whole
    kFailed    ///< it could not be run to an end
  };
  Status status = Status::kMissing;
  std::string why;      ///< of a failure, one line
  std::string host;     ///< where it was run
  std::string version;  ///< of the program
  std::string started;  ///< UTC
  double wall_s = 0.0;  ///< [s] of the whole process
};

std::string to_string(CellRecord::Status status);

/// The cells of a study on disk:
///   cells/ID/        the folder of the mission (run folder) or of the bench
///   cells/ID.json    its record, from the moment it is begun
///   cells/ID.yaml    of a mission: its configuration, until the run folder is whole
///   cells/ID.log     what it said, if it failed
///   cells/ID.lock    held by the process that runs it
/// A cell is done if lacks_of_run() or lacks_of_bench() finds nothing. So one that was killed, at
/// any moment, is run again. Several processes may use one store at a time.
class CellStore {
 public:
  /// Makes the folders. Throws InputError if that is refused (OutputFolder::shared()).
  CellStore(const std::string& folder, Study::Kind kind);
  /// A store that is only read: nothing is made.
  static CellStore existing(const std::string& folder, Study::Kind kind);

  const std::string& folder() const { return folder_; }
  std::string run_folder(const std::string& id) const { return path(id, ""); }
  std::string path(const std::string& id, const std::string& extension) const;

  /// What the folder of a cell lacks; "" if it is whole.
  std::string lacks(const std::string& id) const;
  /// A cell that is whole but has no record of it (its process was killed just then) is kDone.
  CellRecord record(const std::string& id) const;
  /// The record of a cell that is begun: it counts as missing until the next one.
  void write_begun(const std::string& id, const CellRecord& record) const;
  /// Throws InputError where the record cannot be written: the disk is full, say.
  void write(const std::string& id, const CellRecord& record) const;

 private:
  struct OnlyRead {};
  CellStore(OnlyRead, const std::string& folder, Study::Kind kind) : folder_(folder), kind_(kind) {}
  void write(const std::string& id, const CellRecord& record, const char* status) const;

  std::string folder_;
  Study::Kind kind_;
};

/// Whether a run folder holds a whole mission; "" or what it lacks: the summary, which is written
/// last; a mission that was not cancelled; a row of steps.csv for each step.
std::string lacks_of_run(const std::string& run_folder);

}  // namespace prospect

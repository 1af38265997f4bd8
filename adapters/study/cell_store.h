#pragma once

#include <string>

#include "adapters/run/summary.h"

namespace prospect {

/// What is known of a cell besides its run folder.
struct CellRecord {
  enum class Status {
    kMissing,  ///< never begun, or broken off
    kDone,     ///< its run folder is whole
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
///   cells/ID/        the run folder
///   cells/ID.json    its record, from the moment it is begun
///   cells/ID.yaml    its configuration, until the run folder is whole
///   cells/ID.log     what it said, if it failed
///   cells/ID.lock    held by the process that runs it
/// A run folder counts as whole if it has its summary, which is written last, the mission was not
/// cancelled, and steps.csv has a row for each step. So a cell that was killed, at any moment, is
/// run again. Several processes may use one store at a time.
class CellStore {
 public:
  /// Makes the folders. Throws InputError if they cannot be made.
  explicit CellStore(const std::string& folder);
  /// A store that is only read: nothing is made.
  static CellStore existing(const std::string& folder);

  const std::string& folder() const { return folder_; }
  std::string run_folder(const std::string& id) const { return path(id, ""); }
  std::string path(const std::string& id, const std::string& extension) const;

  /// A cell that is whole but has no record of it (its process was killed just then) is kDone.
  CellRecord record(const std::string& id) const;
  /// The record of a cell that is begun: it counts as missing until the next one.
  void write_begun(const std::string& id, const CellRecord& record) const;
  /// Throws InputError where the record cannot be written: the disk is full, say.
  void write(const std::string& id, const CellRecord& record) const;

 private:
  CellStore() = default;
  void write(const std::string& id, const CellRecord& record, const char* status) const;

  std::string folder_;
};

/// Whether a run folder holds a whole mission; "" or what it lacks.
std::string lacks_of_run(const std::string& run_folder);

}  // namespace prospect

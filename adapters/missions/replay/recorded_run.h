// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/missions/config/registries.h"

namespace prospect {

/// What a run left behind that its mission can be driven again from.
struct RecordedRun {
  std::string source;        ///< folder or log, for messages
  std::string world;         ///< name
  std::string world_source;  ///< as explore was given it; the name, of a run that did not say
  std::string world_hash;    ///< of what it held; "" of a run that did not say
  std::uint64_t seed = 0;
  std::string version, commit;
  bool real_time = false;
  std::string configuration;  ///< effective, as YAML
  /// steps.csv: header and a row a planning step. Of a log those that its messages tell, as
  /// rows_of_log() has them; none of the log of a run in real time, which is not driven again.
  std::string header;
  std::vector<std::string> rows;
  std::optional<BagFile> log;  ///< of a run that is given as its log
  bool whole = true;           ///< it came to its end: it was not killed or cancelled
};

/// Reads a run folder, or the log of a mission (.mcap). Throws InputError, one line: neither of
/// them, no run.json, steps.csv that is cut in the middle of a row.
RecordedRun read_recorded_run(const std::string& path, const Registries& registries);

/// The rows of a log, for two logs to be compared: the columns of steps.csv, as far as its messages
/// tell them.
struct LogRows {
  std::string header;
  std::vector<std::string> rows;
};
LogRows rows_of_log(const std::string& path, const Registries& registries);

/// Of a row of steps.csv the columns that a recorded run has: a later version may tell more. All of
/// it where one of them is missing.
class RecordedColumns {
 public:
  RecordedColumns(const std::string& recorded_header, const std::string& header);
  std::string of(const std::string& row) const;

 private:
  bool all_ = true;
  std::vector<std::size_t> kept_;
};

/// Where two runs part, in the columns that the recorded one has.
struct RunDifference {
  int step = -1;     ///< the first that differs, from 0; -1: none
  std::string what;  ///< "cost: 1.5 recorded, 1.4 now", "121 steps recorded, 120 now"
};
RunDifference first_difference(const RecordedRun& recorded, const std::string& header,
                               const std::vector<std::string>& rows);

}  // namespace prospect

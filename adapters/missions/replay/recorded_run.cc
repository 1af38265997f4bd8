// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/recorded_run.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/missions/run/step_row.h"
#include "adapters/missions/run/summary.h"
#include "runtime/mission.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

std::string file_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path.string(), "no such file; expected the folder of a run");
  return std::string(std::istreambuf_iterator<char>(in), {});
}

/// Header and rows, each without its newline.
void split_rows(const std::string& text, const std::string& source, std::string& header,
                std::vector<std::string>& rows) {
  if (text.empty() || text.back() != '\n')
    fail(source, "cut in the middle of a row; expected rows");
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    std::string row = text.substr(at, end - at);
    at = end + 1;
    if (header.empty()) {
      header = std::move(row);
    } else {
      rows.push_back(std::move(row));
    }
  }
}

/// Of a summary as JSON, "" if there is none.
bool came_to_its_end(const std::string& json) {
  const std::optional<Summary> summary = summary_from_json(json);
  return summary && summary->end != MissionEnd::kCancelled;
}

RecordedRun read_folder(const fs::path& folder) {
  RecordedRun run;
  run.source = folder.string();
  const std::string file = (folder / "run.json").string();
  const nlohmann::json json = nlohmann::json::parse(file_text(file), nullptr, false);
  const auto text = [&](const char* key, bool required = true) {
    if (json.is_object() && json.contains(key) && json[key].is_string()) {
      return json[key].get<std::string>();
    }
    if (required) fail(file, std::string("no ") + key + "; expected what explore wrote");
    return std::string();
  };
  run.world = text("world");
  run.world_source = text("world_source", false);
  run.world_hash = text("world_hash", false);
  run.version = text("version");
  run.commit = text("commit");
  if (!json.contains("seed") || !json["seed"].is_number_unsigned()) {
    fail(file, "no seed; expected what explore wrote");
  }
  run.seed = json["seed"].get<std::uint64_t>();
  run.real_time = json.value("real_time", false);
  run.configuration = file_text(folder / "config.yaml");
  const std::string steps = (folder / "steps.csv").string();
  split_rows(file_text(steps), steps, run.header, run.rows);
  if (run.world_source.empty()) run.world_source = run.world;
  std::ifstream summary(folder / "summary.json", std::ios::binary);
  run.whole = came_to_its_end(std::string(std::istreambuf_iterator<char>(summary), {}));
  return run;
}

LogRows rows_of(const LoggedRun& logged) {
  const StepColumns columns = step_columns(logged.record.steps);
  LogRows out;
  out.header = step_header(columns);
  out.header.pop_back();
  for (const StepRecord& step : logged.record.steps) {
    out.rows.push_back(step_row(step, columns));
    out.rows.back().pop_back();
  }
  return out;
}

RecordedRun read_log(const std::string& path, const Registries& registries) {
  RecordedRun run;
  run.source = path;
  const BagFile bag = BagFile::open(path);
  run.log = bag;
  const BagFile::Fields* fields = bag.metadata(topic::kRun);
  if (!fields) fail(path, "no mission's log; expected one of explore or drive");
  const auto entry = [&](const char* name) {
    const auto found = fields->find(name);
    return found == fields->end() ? std::string() : found->second;
  };
  run.world = entry("world");
  run.world_source = entry("world_source");
  run.world_hash = entry("world_hash");
  run.version = entry("version");
  run.commit = entry("commit");
  run.real_time = entry("real_time") == "1";
  run.configuration = entry("configuration");
  if (!parse_number(entry("seed"), run.seed)) fail(path, "no seed; expected a mission's log");
  if (run.world_source.empty()) run.world_source = run.world;
  const BagFile::Fields* end = bag.metadata(topic::kSummary);
  run.whole = end && end->count("json") && came_to_its_end(end->at("json"));
  if (run.real_time) return run;
  LogRows rows = rows_of(read_logged_run(bag, path, registries));
  run.header = std::move(rows.header);
  run.rows = std::move(rows.rows);
  return run;
}

std::vector<std::string> fields_of_row(const std::string& row) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : row) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// The first column in which two rows differ, in words.
std::string column_difference(const std::string& header, const std::string& a,
                              const std::string& b) {
  const std::vector<std::string> names = fields_of_row(header), left = fields_of_row(a),
                                 right = fields_of_row(b);
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    const std::string was = i < left.size() ? left[i] : "", is = i < right.size() ? right[i] : "";
    if (was == is) continue;
    const auto shown = [](const std::string& text) { return text.empty() ? "nothing" : text; };
    return (i < names.size() ? names[i] : "a column") + ": " + shown(was) + " recorded, " +
           shown(is) + " now";
  }
  return "";
}

}  // namespace

RecordedRun read_recorded_run(const std::string& path, const Registries& registries) {
  if (fs::path(path).extension() == ".mcap") return read_log(path, registries);
  if (!fs::is_directory(path)) {
    throw InputError(path + ": no run; expected the folder of one, or a mission's log (.mcap)");
  }
  return read_folder(path);
}

LogRows rows_of_log(const std::string& path, const Registries& registries) {
  return rows_of(read_logged_run(path, registries));
}

RecordedColumns::RecordedColumns(const std::string& recorded_header, const std::string& header) {
  if (recorded_header == header) return;
  const std::vector<std::string> now = fields_of_row(header);
  for (const std::string& name : fields_of_row(recorded_header)) {
    const auto found = std::find(now.begin(), now.end(), name);
    if (found == now.end()) return;
    kept_.push_back(static_cast<std::size_t>(found - now.begin()));
  }
  all_ = false;
}

std::string RecordedColumns::of(const std::string& row) const {
  if (all_) return row;
  const std::vector<std::string> fields = fields_of_row(row);
  std::string kept;
  for (std::size_t n = 0; n < kept_.size(); ++n) {
    kept += (n > 0 ? "," : "") + (kept_[n] < fields.size() ? fields[kept_[n]] : "");
  }
  return kept;
}

RunDifference first_difference(const RecordedRun& recorded, const std::string& told_header,
                               const std::vector<std::string>& told_rows) {
  const RecordedColumns columns(recorded.header, told_header);
  const std::string header = columns.of(told_header);
  std::vector<std::string> rows;
  for (const std::string& row : told_rows) rows.push_back(columns.of(row));
  if (recorded.header != header) {
    return {0, "its columns: " + column_difference(recorded.header, recorded.header, header)};
  }
  for (std::size_t i = 0; i < std::min(recorded.rows.size(), rows.size()); ++i) {
    if (recorded.rows[i] == rows[i]) continue;
    return {static_cast<int>(i), column_difference(header, recorded.rows[i], rows[i])};
  }
  if (recorded.rows.size() == rows.size()) return {};
  return {static_cast<int>(std::min(recorded.rows.size(), rows.size())),
          std::to_string(recorded.rows.size()) + " steps recorded, " + std::to_string(rows.size()) +
              " now"};
}

}  // namespace prospect

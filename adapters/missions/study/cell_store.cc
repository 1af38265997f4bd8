// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/cell_store.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/files/whole_file.h"
#include "adapters/missions/run/summary.h"
#include "adapters/missions/study/bench_settings.h"
#include "runtime/mission.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

constexpr const char* kBegun = "begun";

}  // namespace

std::string to_string(CellRecord::Status status) {
  switch (status) {
    case CellRecord::Status::kMissing:
      return "missing";
    case CellRecord::Status::kDone:
      return "done";
    case CellRecord::Status::kFailed:
      return "failed";
  }
  return "?";
}

std::string lacks_of_run(const std::string& run_folder) {
  const std::optional<std::string> text = text_of(run_folder + "/summary.json");
  if (!text) return "no summary.json";
  const std::optional<Summary> summary = summary_from_json(*text);
  if (!summary) return "summary.json is damaged";
  if (summary->end == MissionEnd::kCancelled) return "the mission was cancelled";
  const std::optional<std::string> steps = text_of(run_folder + "/steps.csv");
  if (!steps) return "no steps.csv";
  const auto rows = std::count(steps->begin(), steps->end(), '\n') - 1;
  if (rows != summary->steps) {
    return "steps.csv has " + std::to_string(rows) + " of " + std::to_string(summary->steps) +
           " rows";
  }
  return "";
}

CellStore::CellStore(const std::string& folder, Study::Kind kind)
    : CellStore(OnlyRead(), folder, kind) {
  OutputFolder::shared(folder, {"study"}).claim_folder("cells");
}

CellStore CellStore::existing(const std::string& folder, Study::Kind kind) {
  return {OnlyRead(), folder, kind};
}

std::string CellStore::lacks(const std::string& id) const {
  return kind_ == Study::Kind::kBenches ? lacks_of_bench(run_folder(id))
                                        : lacks_of_run(run_folder(id));
}

std::string CellStore::path(const std::string& id, const std::string& extension) const {
  return (fs::path(folder_) / "cells" / (id + extension)).string();
}

CellRecord CellStore::record(const std::string& id) const {
  CellRecord record;
  const std::optional<std::string> text = text_of(path(id, ".json"));
  bool done = false, failed = false;
  if (text) {
    const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
    const auto word = [&](const char* key) {
      return json.is_object() && json.contains(key) && json[key].is_string()
                 ? json[key].get<std::string>()
                 : std::string();
    };
    done = word("status") == to_string(CellRecord::Status::kDone);
    failed = word("status") == to_string(CellRecord::Status::kFailed);
    record.why = word("why");
    record.host = word("host");
    record.version = word("version");
    record.started = word("started");
    if (json.is_object() && json.contains("wall_s") && json["wall_s"].is_number()) {
      record.wall_s = json["wall_s"].get<double>();
    }
  }
  std::error_code error;
  // What was found whole once need not be read through again.
  const char* const last = kind_ == Study::Kind::kBenches ? "bench.json" : "summary.json";
  const bool found_whole = done && fs::is_regular_file(fs::path(run_folder(id)) / last, error);
  if (failed) {
    record.status = CellRecord::Status::kFailed;
  } else if (found_whole || lacks(id).empty()) {
    record.status = CellRecord::Status::kDone;
  }
  return record;
}

void CellStore::write(const std::string& id, const CellRecord& record, const char* status) const {
  nlohmann::ordered_json json = {{"status", status},
                                 {"host", record.host},
                                 {"version", record.version},
                                 {"started", record.started}};
  if (!record.why.empty()) json["why"] = record.why;
  if (record.wall_s > 0.0) json["wall_s"] = record.wall_s;
  const std::string file = path(id, ".json");
  const std::string wrong = write_whole_file(
      file, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
  if (!wrong.empty()) fail(file, "cannot be written (" + wrong + "); expected a writable folder");
}

void CellStore::write_begun(const std::string& id, const CellRecord& record) const {
  write(id, record, kBegun);
}

void CellStore::write(const std::string& id, const CellRecord& record) const {
  write(id, record, to_string(record.status).c_str());
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/other_versions.h"

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/recorded_configuration.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// What the mission of a run folder is named by this program; none if it cannot be told.
std::optional<std::string> name_today(const std::string& run_folder, const std::string& program,
                                      const Registries& registries) {
  std::ifstream in(run_folder + "/run.json", std::ios::binary);
  const nlohmann::json run = nlohmann::json::parse(in, nullptr, false);
  const bool told = run.is_object() && run.contains("world_hash") &&
                    run["world_hash"].is_string() && run.contains("seed") &&
                    run["seed"].is_number_unsigned();
  if (!told) return std::nullopt;
  const std::string text = run["world_hash"].get<std::string>();
  std::uint64_t world = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), world, 16);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  try {
    const std::string file = run_folder + "/config.yaml";
    const std::string read =
        recorded_yaml(read_configuration(file, registries, settings_before_their_keys()),
                      ConfigurationUse::kExplore);
    return cell_name(configuration_from_text(read, file, registries), std::nullopt, world,
                     run["seed"].get<std::uint64_t>(), program);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::map<std::string, std::string> other_versions(const StudyPlan& plan, const CellStore& store,
                                                  const Registries& registries) {
  std::set<std::string> wanted;
  for (const StudyCell& cell : plan.cells) wanted.insert(cell.id);
  std::set<std::string> stored;  // in one order on every machine
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(store.folder()) / "cells", error)) {
    if (entry.is_directory(error)) stored.insert(entry.path().filename().string());
  }
  std::map<std::string, std::string> found, started;
  for (const std::string& id : stored) {
    if (wanted.contains(id)) continue;
    const CellRecord record = store.record(id);
    if (record.status != CellRecord::Status::kDone) continue;
    const std::optional<std::string> name =
        name_today(store.run_folder(id), plan.program, registries);
    if (!name || !wanted.contains(*name)) continue;
    if (found.contains(*name) && record.started <= started[*name]) continue;
    found[*name] = id;
    started[*name] = record.started;
  }
  return found;
}

}  // namespace prospect

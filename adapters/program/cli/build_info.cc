// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/build_info.h"

#include <link.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "adapters/program/cli/build_versions.h"
#include "adapters/program/cli/commit.h"
#include "models/version.h"

namespace prospect {
namespace {

/// Paths of the shared libraries in this process.
std::vector<std::string> loaded_libraries() {
  std::vector<std::string> paths;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* found) {
        if (info->dlpi_name != nullptr && *info->dlpi_name != '\0') {
          static_cast<std::vector<std::string>*>(found)->emplace_back(info->dlpi_name);
        }
        return 0;
      },
      &paths);
  return paths;
}

/// File name, links followed, of the first whose name begins like that; "".
std::string file_of(const std::vector<std::string>& loaded, const std::string& begin) {
  if (begin.empty()) return "";
  for (const std::string& path : loaded) {
    if (!std::filesystem::path(path).filename().string().starts_with(begin)) continue;
    std::error_code error;
    const std::filesystem::path real = std::filesystem::canonical(path, error);
    return (error ? std::filesystem::path(path) : real).filename().string();
  }
  return "";
}

}  // namespace

BuildInfo build_info() {
  BuildInfo info;
  info.version = kVersion;
  info.commit = commit();
  info.commit_changed = commit_changed();
  info.compiler = compiler();
  info.flags = compiler_flags();
  info.build_type = build_type();
  const std::vector<std::string> loaded = loaded_libraries();
  for (const BuiltWith& library : libraries_built_with()) {
    info.libraries.push_back({library.name, library.version, file_of(loaded, library.file)});
  }
  std::string blas = file_of(loaded, "libblas");
  if (blas.empty()) blas = file_of(loaded, "libopenblas");
  if (!blas.empty()) info.libraries.push_back({"BLAS", "", blas});
  return info;
}

nlohmann::ordered_json to_json(const BuildInfo& info) {
  nlohmann::ordered_json libraries = nlohmann::ordered_json::array();
  for (const LibraryVersion& library : info.libraries) {
    libraries.push_back({{"name", library.name},
                         {"built_with", library.built_with},
                         {"runs_with", library.runs_with}});
  }
  return {
      {"version", info.version},   {"commit", info.commit}, {"commit_changed", info.commit_changed},
      {"compiler", info.compiler}, {"flags", info.flags},   {"build_type", info.build_type},
      {"libraries", libraries}};
}

std::string to_text(const BuildInfo& info) {
  const auto row = [](const std::string& name, const std::string& value) {
    return name + std::string(name.size() < 13 ? 13 - name.size() : 1, ' ') + value + '\n';
  };
  std::string text = "prospect " + info.version + '\n';
  text += row("commit", info.commit.empty()
                            ? "none: built without git"
                            : info.commit + (info.commit_changed ? ", with changes" : ""));
  text += row("compiler", info.compiler) + row("flags", info.flags) +
          row("build type", info.build_type);
  std::size_t widest = 0;
  for (const LibraryVersion& library : info.libraries) {
    widest = std::max(widest, library.built_with.size());
  }
  for (const LibraryVersion& library : info.libraries) {
    std::string built = library.built_with;
    if (!library.runs_with.empty()) {
      built.resize(widest, ' ');
      built += "  runs with " + library.runs_with;
    }
    text += row(library.name, built);
  }
  return text;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t at = line.find_first_not_of(": \t", line.find(':'));
    return at == std::string::npos ? "" : line.substr(at);
  }
  return "";
}

}  // namespace prospect

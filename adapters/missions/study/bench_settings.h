// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "engine/problem/solver.h"
#include "solvers/registry.h"

namespace prospect {

/// How a cell of Study::Kind::kBenches solves its problems: as `prospect bench` with one back end
/// and one deadline.
struct BenchSettings {
  std::string solver = "nlopt";
  Options options;      ///< of the back end: key `options.NAME`
  double deadline = 0;  ///< [s]; 0: none
  int max_evaluations = 10000;
  int repeats = 1;
  std::vector<ConfigEntry> entries;  ///< what is in effect, by which a cell is named
};

/// From settings, "deadline=0.1", "options.candidates=200"; a later one stands above an earlier
/// one. Throws InputError with every problem at once, `--set KEY=VALUE: what; expected what`.
BenchSettings read_bench_settings(const std::vector<YamlSetting>& settings,
                                  const SolverRegistry& solvers);

/// The arguments of `prospect bench`, with the word `bench` first, that solve such a cell into a
/// folder; what the folder has is not solved again.
std::vector<std::string> bench_words(const BenchSettings& settings, const std::string& problems,
                                     std::uint64_t seed, const std::string& folder);

/// Whether the folder holds a whole bench of one cell; "" or what it lacks: bench.json, which is
/// written last; every problem (it was cancelled); a row for each problem.
std::string lacks_of_bench(const std::string& folder);

}  // namespace prospect

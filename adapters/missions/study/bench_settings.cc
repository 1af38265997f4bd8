// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/bench_settings.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <variant>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/solver_options.h"
#include "models/range_text.h"

namespace prospect {
namespace {

std::string option_text(const OptionValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return std::to_string(*whole);
  if (const double* number = std::get_if<double>(&value)) return exact_text(*number);
  return std::get<std::string>(value);
}

}  // namespace

BenchSettings read_bench_settings(const std::vector<YamlSetting>& settings,
                                  const SolverRegistry& solvers) {
  StrictYaml yaml = StrictYaml::from_text("", "settings");
  for (const YamlSetting& setting : settings) yaml.set(setting);
  YamlMap root = yaml.root();
  BenchSettings read;
  read.solver = root.text("solver", read.solver, "back end, see `prospect list solvers`");
  YamlMap options = root.free_map("options", "of the back end");
  if (const std::string wrong = solver_problem(read.solver, solvers); !wrong.empty()) {
    root.problem("solver", wrong);
    for (const std::string& name : options.keys()) options.text(name, "", "of the back end");
  } else {
    read.options = read_solver_options(options, *solvers.make(read.solver));
  }
  for (const auto& [name, value] : read.options) {
    if (option_text(value).find(',') != std::string::npos) {
      options.problem(name, "holds a comma; expected none");
    }
  }
  read.deadline = root.number("deadline", read.deadline, 0.0, 3600.0, "s",
                              "wall-clock limit of each solve; 0: none");
  read.max_evaluations = static_cast<int>(
      root.integer("max_evaluations", read.max_evaluations, 1, 100000000, "",
                   "of each solve, unless an option of the back end says otherwise"));
  read.repeats = static_cast<int>(
      root.integer("repeats", read.repeats, 1, 1000, "", "how often each solve is made"));
  yaml.finish();
  read.entries = yaml.entries();
  return read;
}

std::vector<std::string> bench_words(const BenchSettings& settings, const std::string& problems,
                                     std::uint64_t seed, const std::string& folder) {
  std::string solver = settings.solver;
  for (const auto& [name, value] : settings.options) {
    solver += ',' + name + '=' + option_text(value);
  }
  return {"bench",
          problems,
          "--solver",
          solver,
          "--deadline",
          exact_text(settings.deadline),
          "--max-evaluations",
          std::to_string(settings.max_evaluations),
          "--repeat",
          std::to_string(settings.repeats),
          "--seed",
          std::to_string(seed),
          "--out",
          folder,
          "--resume",
          "--quiet"};
}

std::string lacks_of_bench(const std::string& folder) {
  std::ifstream in(folder + "/bench.json", std::ios::binary);
  if (!in) return "no bench.json";
  const nlohmann::json bench = nlohmann::json::parse(in, nullptr, false);
  const auto cancelled = bench.is_object() ? bench.find("cancelled") : bench.end();
  if (!bench.is_object() || cancelled == bench.end() || !cancelled->is_boolean()) {
    return "bench.json is damaged";
  }
  if (cancelled->get<bool>()) return "the bench was cancelled";
  try {
    const BenchTable table = read_bench_rows(folder);
    std::size_t problems = 0;
    for (const ProblemSetFacts& set : table.sets) problems += set.problems.size();
    if (table.rows.size() == problems) return "";
    return std::string(kBenchRows) + " has " + std::to_string(table.rows.size()) + " of " +
           std::to_string(problems) + " rows";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace prospect

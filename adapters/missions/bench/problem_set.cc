// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/problem_set.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/whole_file.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/formats/programmes/nl_reader.h"
#include "adapters/missions/bench/expression_file.h"
#include "adapters/missions/bench/mission_set.h"
#include "adapters/missions/bench/stated_problem.h"
#include "models/formatted.h"
#include "models/nearest_name.h"
#include "problems/path_problem.h"
#include "problems/quadrotors.h"
#include "problems/r1.h"
#include "problems/zoo.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kBestFile = "best_known.json";

ProblemSet zoo_set() {
  ProblemSet set{"zoo", "known optima", 0.0, {}, "", {}};
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    for (const FunctionProblem& p : problems) {
      set.problems.push_back(started(p.name, p.problem(), p.start, p.optimum));
      set.problems.back().stated = [p] { return p.stated(); };
    }
  }
  PathProblem path = path_problem();
  const Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(path.problem.num_variables());
  set.problems.push_back(started("path past a disc", std::move(path.problem), at_rest, 0.0));
  set.problems.back().stated = [stated = std::move(path.stated)] { return stated; };
  return set;
}

ProblemSet s30_set(bool quick) {
  ProblemSet set{"s30", "best of 200 local solves from random inputs each", 0.01, {}, "", {}};
  const std::vector<Eigen::Vector3d> starts = r1_starts(17, 30);
  for (std::size_t i = 0; i < starts.size(); i += quick ? 5 : 1) {
    set.problems.push_back(
        started("start " + std::to_string(i), make_r1(starts[i]), r1_cold(), s30_best_known()[i]));
    set.problems.back().stated = [x0 = starts[i]] { return r1_stated(x0); };
  }
  return set;
}

ProblemSet quadrotor_set(bool quick) {
  ProblemSet set{"quadrotors", "", 0.01, {}, "", {}};
  const auto add = [&](const std::string& name, Problem problem) {
    const Eigen::VectorXd hovering = quad_hovering(problem);
    set.problems.push_back(started(name, std::move(problem), hovering, std::nullopt));
  };
  // The wider of the two arcs of starts, every fourth of eighty.
  for (int i = 0; i < 80; i += quick ? 40 : 4) {
    const double angle = std::numbers::pi * (i / 79.0 - 0.25);
    add("nav_circle " + std::to_string(i), quad_nav_circle(angle));
  }
  for (const double speed : {1.0, 1.5, 2.0}) {
    for (int i = 0; i < 10; i += quick ? 5 : 1) {
      const double place = 0.2 * std::numbers::pi * i;
      if (!quad_track_begins_free(place)) continue;
      add(formatted("track_avoid %g %d", speed, i), quad_track_avoid(speed, place));
    }
  }
  for (const int count : {2, 4}) {
    if (!quick) add("multi_swap " + std::to_string(count), quad_multi_swap(count));
  }
  return set;
}

BenchProblem problem_of(const std::string& name, std::shared_ptr<const Problem> problem,
                        const std::vector<Seed>& seeds, const WarmStart* warm_start) {
  BenchProblem made;
  made.name = name;
  made.problem = std::move(problem);
  if (warm_start) made.start = *warm_start;
  if (seeds.empty()) return made;
  if (made.start.x.size() == 0) made.start.x = seeds.front().z;
  made.start.seeds.resize(made.problem->num_variables(), static_cast<Eigen::Index>(seeds.size()));
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    made.start.seeds.col(static_cast<Eigen::Index>(i)) = seeds[i].z;
  }
  return made;
}

BenchProblem problem_of_file(const std::string& path, const std::string& name,
                             const TermRegistry& terms) {
  if (fs::path(path).extension() == ".nl") {
    StatedProgramme programme = read_nl(path);
    programme.name = name;
    return stated_problem(std::move(programme));
  }
  const ReadProblem read = read_problem(path, terms);
  const std::optional<WarmStart>& warm_start = read.saved.warm_start;
  return problem_of(name, read.problem, read.saved.seeds, warm_start ? &*warm_start : nullptr);
}

ProblemSet mission_set(const Configuration& configuration, const Registries& registries, bool quick,
                       const CaptureWatch& watch) {
  ProblemSet set{"missions", "", 1e-3, {}, "", {}};
  capture_missions(
      quick ? quick_missions() : default_missions(), configuration, registries,
      [&](const SavedProblem& saved) {
        const std::string file = problem_file_name(saved.origin);
        set.problems.push_back(problem_of(file.substr(0, file.size() - 3),
                                          make_problem(saved.specification), saved.seeds, nullptr));
      },
      watch);
  return set;
}

/// A set that a plug-in brings. Throws InputError if one of its problems cannot be made.
ProblemSet named_set(const std::string& name, const ProblemRegistry& registry) {
  ProblemSet set;
  set.name = name;
  set.absolute_tolerance = 0.0;
  for (const ProblemEntry& entry : registry.problems(name)) {
    const std::string which = "problem '" + entry.name + "' of set '" + name + "': ";
    try {
      auto problem = std::make_shared<const Problem>(entry.make());
      const Eigen::VectorXd middle = 0.5 * (problem->lower() + problem->upper());
      const Eigen::VectorXd start = entry.start ? entry.start() : middle;
      if (start.size() != problem->num_variables() || !start.allFinite()) {
        throw std::invalid_argument("starts at " + std::to_string(start.size()) +
                                    " numbers; expected " +
                                    std::to_string(problem->num_variables()) + " finite ones");
      }
      BenchProblem made;
      made.name = entry.name;
      made.problem = std::move(problem);
      made.start.x = start;
      made.best_known = entry.best_known;
      if (made.best_known) set.best_known_source = "the plug-in that brings the set";
      set.problems.push_back(std::move(made));
    } catch (const std::exception& e) {
      throw InputError(which + e.what());
    } catch (...) {
      throw InputError(which + "an exception that is not a std::exception");
    }
  }
  return set;
}

/// best_known.json: {"costs": {"name of a problem": its best known cost, ...}}.
void read_best_known(ProblemSet& set) {
  const std::string path = (fs::path(set.folder) / kBestFile).string();
  if (std::error_code error; !fs::exists(path, error)) return;
  const char* const expected = "; expected {\"costs\": {\"PROBLEM\": number, ...}}";
  std::ifstream file(path, std::ios::binary);
  const Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded()) throw InputError(path + ": is no JSON" + expected);
  const auto costs = json.is_object() ? json.find("costs") : json.end();
  if (!json.is_object() || costs == json.end() || !costs->is_object()) {
    throw InputError(path + ": has no costs" + expected);
  }
  for (BenchProblem& problem : set.problems) {
    const auto found = costs->find(problem.name);
    if (found == costs->end()) continue;
    if (!found->is_number() || !std::isfinite(found->get<double>())) {
      throw InputError(path + ": '" + problem.name + "' is no number" + expected);
    }
    problem.best_known = found->get<double>();
  }
}

ProblemSet folder_set(const std::string& path, const TermRegistry& terms) {
  ProblemSet set;
  const fs::path folder = fs::path(path).lexically_normal();
  set.name =
      folder.has_filename() ? folder.filename().string() : folder.parent_path().filename().string();
  if (set.name.empty() || set.name == ".") set.name = path;
  set.best_known_source = std::string("best costs kept in ") + kBestFile;
  set.folder = path;
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if ((extension == ".h5" || extension == ".nl") && entry->is_regular_file()) {
      files.push_back(fs::relative(entry->path(), path).generic_string());
    }
  }
  if (error)
    throw InputError(path + ": cannot be read (" + error.message() +
                     "); expected a folder of problem files");
  if (files.empty())
    throw InputError(path +
                     ": holds no problem file (.h5, .nl); expected a folder of problem files");
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    set.files.push_back((fs::path(path) / file).string());
    std::string name = file.substr(0, file.size() - 3);
    // Of two files of one name the second keeps its extension.
    const auto taken = [&](const BenchProblem& problem) { return problem.name == name; };
    if (std::any_of(set.problems.begin(), set.problems.end(), taken)) name = file;
    set.problems.push_back(problem_of_file(set.files.back(), name, terms));
  }
  const bool all_stated = std::all_of(set.problems.begin(), set.problems.end(),
                                      [](const BenchProblem& p) { return bool(p.stated); });
  if (all_stated) set.absolute_tolerance = 0.0;  // the unit of their costs is anybody's
  read_best_known(set);
  return set;
}

struct BuiltinSet {
  const char* name;
  const char* summary;
};
constexpr BuiltinSet kBuiltinSets[] = {
    {"zoo",
     "thirteen small problems with known optima, with and without constraints, two badly scaled"},
    {"s30", "R1, an exploration problem of 40 variables with many basins, from thirty starts"},
    {"quadrotors",
     "three problems of others, 46 of 116 to 464 variables, states bounded, hundreds of rows"},
    {"missions", "112 planning problems of missions on eight maps, driven first: takes minutes"},
};

}  // namespace

BenchProblem started(std::string name, Problem problem, const Eigen::VectorXd& x,
                     std::optional<double> best_known) {
  BenchProblem made;
  made.name = std::move(name);
  made.problem = std::make_shared<const Problem>(std::move(problem));
  made.start.x = x;
  made.best_known = best_known;
  return made;
}

std::string problem_fingerprint(const BenchProblem& problem) {
  // Fowler, Noll and Vo's FNV-1a.
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&](const double* numbers, Eigen::Index count) {
    for (Eigen::Index i = 0; i < count; ++i) {
      for (std::uint64_t bits = std::bit_cast<std::uint64_t>(numbers[i]), byte = 0; byte < 8;
           ++byte) {
        hash = (hash ^ ((bits >> (8 * byte)) & 0xffU)) * 1099511628211U;
      }
    }
  };
  const Problem& p = *problem.problem;
  const Eigen::VectorXd middle = 0.5 * (p.lower() + p.upper());
  const double size = p.num_constraints();
  add(&size, 1);
  add(p.lower().data(), p.lower().size());
  add(p.upper().data(), p.upper().size());
  add(problem.start.x.data(), problem.start.x.size());
  add(problem.start.seeds.data(), problem.start.seeds.size());
  Workspace workspace = p.make_workspace();
  Evaluation e;
  for (const Eigen::VectorXd& x : {problem.start.x, middle}) {
    if (x.size() != p.num_variables()) continue;
    try {
      p.evaluate(x, Evaluate::kValue, workspace, e);
    } catch (...) {
      continue;
    }
    add(e.cost.data(), e.cost.size());
    add(e.constraints.data(), e.constraints.size());
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::uint64_t problem_set_hash(const ProblemSet& set) {
  ContentHash hash;
  for (const BenchProblem& problem : set.problems) {
    hash.add(problem.name).add(problem_fingerprint(problem));
  }
  for (const std::string& file : set.files) hash.add(file_hash(file));
  return hash.value();
}

std::vector<std::string> builtin_set_names() {
  std::vector<std::string> names;
  for (const BuiltinSet& set : kBuiltinSets) names.emplace_back(set.name);
  return names;
}

std::string builtin_set_summary(const std::string& name) {
  for (const BuiltinSet& set : kBuiltinSets) {
    if (name == set.name) return set.summary;
  }
  return "";
}

ProblemSet make_problem_set(const std::string& text, const Configuration& configuration,
                            const Registries& registries, bool quick, const CaptureWatch& watch) {
  if (text == "zoo") return zoo_set();
  if (text == "s30") return s30_set(quick);
  if (text == "quadrotors") return quadrotor_set(quick);
  if (text == "missions") return mission_set(configuration, registries, quick, watch);
  if (!registries.problems.problems(text).empty()) return named_set(text, registries.problems);
  std::error_code error;
  const fs::file_status status = fs::status(text, error);
  if (fs::is_directory(status)) return folder_set(text, registries.terms);
  const std::string extension = fs::path(text).extension().string();
  if (extension == ".json") {
    ProblemSet set = read_expression_file(text);
    set.files = {text};
    return set;
  }
  if (extension == ".h5" || extension == ".nl" || fs::exists(status)) {
    ProblemSet set;
    set.name = fs::path(text).stem().string();
    set.files = {text};
    set.problems.push_back(problem_of_file(text, set.name, registries.terms));
    if (set.problems.back().stated) set.absolute_tolerance = 0.0;
    return set;
  }
  std::string names;
  std::vector<std::string> all = builtin_set_names();
  for (const std::string& set : registries.problems.sets()) all.push_back(set);
  for (const std::string& set : all) names += set + ", ";
  throw InputError(
      "problem set '" + text + "': no such file or folder" + did_you_mean(text, all) +
      "; expected one of: " + names +
      "a folder of problem files, a problem file (.h5, .nl), problems as expressions (.json)");
}

void keep_best_known(const ProblemSet& set) {
  Json costs = Json::object();
  for (const BenchProblem& problem : set.problems) {
    if (problem.best_known) costs[problem.name] = *problem.best_known;
  }
  const std::string path = (fs::path(set.folder) / kBestFile).string();
  const std::string wrong = write_whole_file(path, Json{{"costs", costs}}.dump(1) + '\n');
  if (!wrong.empty()) throw std::runtime_error(path + ": cannot be written (" + wrong + ")");
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_plan.h"

#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_hash.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/study/mission_start.h"
#include "models/range_text.h"

namespace prospect {
namespace {

/// Messages about what is read for a line of the study.
InputError located(const InputError& error, const std::string& where) {
  std::vector<std::string> lines;
  for (const std::string& line : error.lines()) lines.push_back(where + line);
  return InputError(lines);
}

/// Every combination of one value an axis, the last axis innermost.
std::vector<std::vector<std::size_t>> grid_points(const std::vector<StudyAxis>& grid) {
  std::vector<std::vector<std::size_t>> points = {{}};
  for (const StudyAxis& axis : grid) {
    std::vector<std::vector<std::size_t>> longer;
    for (const std::vector<std::size_t>& point : points) {
      for (std::size_t n = 0; n < axis.values.size(); ++n) {
        longer.push_back(point);
        longer.back().push_back(n);
      }
    }
    points = std::move(longer);
  }
  return points;
}

/// What of a configuration says how a world is read.
std::string world_settings(const Configuration& configuration) {
  std::string text;
  for (const ConfigEntry& entry : configuration.entries) {
    for (const char* part : {"robot.", "world.", "simulator.", "task."}) {
      if (entry.path.starts_with(part)) text += entry.path + '=' + entry.value + '\n';
    }
  }
  return text;
}

double degrees(double radians) { return radians * 180.0 / M_PI; }

/// "[x, y, yaw]" in m and degrees, as the key world.start.
std::string start_text(const Pose& start) {
  std::string text = "[";
  text += exact_text(start.position.x());
  text += ", ";
  text += exact_text(start.position.y());
  text += ", ";
  text += exact_text(degrees(start.yaw));
  text += ']';
  return text;
}

std::vector<ConfigEntry> with_start(std::vector<ConfigEntry> entries,
                                    const std::optional<Pose>& start) {
  if (!start) return entries;
  for (ConfigEntry& entry : entries) {
    if (entry.path == "world.start") entry.value = start_text(*start);
  }
  return entries;
}

/// Worlds as the ways to run missions read them, each read once.
class StudyWorlds {
 public:
  struct Read {
    World world;
    std::uint64_t hash = 0;
    Grid<std::uint8_t> roomy;  ///< of drawn starts
    /// By seed: the start that is drawn, and the hash of the world with that start, as a mission
    /// reads it from its configuration.
    std::map<std::uint64_t, std::pair<Pose, std::uint64_t>> drawn;
  };

  StudyWorlds(bool draws, const std::function<void(const std::string&)>& progress)
      : draws_(draws), progress_(progress) {}

  Read& read(const StudyInput& world, const Configuration& configuration) {
    const auto key = std::make_pair(world.path, world_settings(configuration));
    const auto found = known_.find(key);
    if (found != known_.end()) return found->second;
    WorldOptions options = world_options_for(configuration);
    if (progress_) {
      progress_("reading " + world.name);
      options.progress = [&](const std::string& what) { progress_(world.name + ": " + what); };
    }
    Read read{load(world, options), 0, {}, {}};
    read.hash = world_hash(read.world);
    if (draws_) read.roomy = roomy_columns(read.world, configuration);
    return known_.emplace(key, std::move(read)).first->second;
  }

  static const std::pair<Pose, std::uint64_t>& draw(Read& read, std::uint64_t seed) {
    const auto found = read.drawn.find(seed);
    if (found != read.drawn.end()) return found->second;
    const Pose own = read.world.start, start = mission_start(own, read.roomy, seed);
    read.world.start = {{start.position.x(), start.position.y(), 0.0},
                        degrees(start.yaw) * M_PI / 180.0};
    const std::uint64_t hash = world_hash(read.world);
    read.world.start = own;
    return read.drawn.emplace(seed, std::pair(start, hash)).first->second;
  }

 private:
  static World load(const StudyInput& world, const WorldOptions& options) {
    try {
      return load_world(world.path, options);
    } catch (const InputError& error) {
      throw located(error, world.where + ": worlds: ");
    }
  }

  bool draws_;
  const std::function<void(const std::string&)>& progress_;
  std::map<std::pair<std::string, std::string>, Read> known_;
};

std::vector<StudySetup> read_setups(const Study& study, const Registries& registries) {
  std::vector<StudySetup> setups;
  std::vector<std::string> problems;
  std::set<std::string> told;
  for (std::size_t c = 0; c < study.conditions.size(); ++c) {
    for (const std::vector<std::size_t>& point : grid_points(study.grid)) {
      std::vector<StudySetting> settings = study.common;
      const std::vector<StudySetting>& own = study.conditions[c].settings;
      settings.insert(settings.end(), own.begin(), own.end());
      for (std::size_t a = 0; a < point.size(); ++a) {
        settings.push_back(study.grid[a].values[point[a]]);
      }
      std::vector<YamlSetting> above;
      for (const StudySetting& s : settings) above.emplace_back(s.key + "=" + s.value, s.where);
      StudySetup& setup = setups.emplace_back();
      setup.condition = c;
      setup.values = point;
      try {
        if (study.kind == Study::Kind::kBenches) {
          setup.bench = read_bench_settings(above, registries.solvers);
        } else {
          setup.configuration =
              read_configuration(study.base, registries, above, ConfigurationUse::kExplore);
        }
      } catch (const InputError& error) {
        for (const std::string& line : error.lines()) {
          if (told.insert(line).second) problems.push_back(line);
        }
      }
    }
  }
  if (!problems.empty()) throw InputError(problems);
  return setups;
}

/// Seeds outermost, setups innermost.
void add_cells(StudyPlan& plan, const std::function<void(StudyCell&)>& name) {
  for (const std::uint64_t seed : plan.study.seeds) {
    for (std::size_t i = 0; i < plan.study.inputs.size(); ++i) {
      for (std::size_t s = 0; s < plan.setups.size(); ++s) {
        plan.cells.push_back({"", s, i, seed, std::nullopt});
        name(plan.cells.back());
      }
    }
  }
}

void plan_missions(StudyPlan& plan, const std::function<void(const std::string&)>& progress) {
  StudyWorlds worlds(plan.study.drawn_starts, progress);
  add_cells(plan, [&](StudyCell& cell) {
    const Configuration& configuration = plan.setup(cell).configuration;
    StudyWorlds::Read& world = worlds.read(plan.study.inputs[cell.input], configuration);
    std::uint64_t hash = world.hash;
    if (plan.study.drawn_starts && cell.seed != 1) {
      std::tie(cell.start, hash) = StudyWorlds::draw(world, cell.seed);
    }
    cell.id = cell_name(configuration, cell.start, hash, cell.seed, plan.program);
  });
}

void plan_benches(StudyPlan& plan, const Registries& registries,
                  const std::function<void(const std::string&)>& progress) {
  const Configuration unused;  // of the set `missions`, which read_study() refuses
  std::vector<std::uint64_t> hashes;
  for (const StudyInput& input : plan.study.inputs) {
    if (progress) progress("reading " + input.name);
    try {
      const ProblemSet set = make_problem_set(input.path, unused, registries, false);
      hashes.push_back(problem_set_hash(set));
      std::vector<std::string>& names = plan.problems.emplace_back();
      for (const BenchProblem& problem : set.problems) names.push_back(problem.name);
    } catch (const InputError& error) {
      throw located(error, input.where + ": problems: ");
    }
  }
  add_cells(plan, [&](StudyCell& cell) {
    ContentHash hash;
    hash.add(std::string_view("prospect study bench 1")).add(plan.program);
    for (const ConfigEntry& entry : plan.setup(cell).bench.entries) {
      hash.add(entry.path).add(entry.value);
    }
    cell.id = hash.add(hashes[cell.input]).add(cell.seed).text();
  });
}

}  // namespace

std::string cell_name(const Configuration& configuration, const std::optional<Pose>& start,
                      std::uint64_t world_hash, std::uint64_t seed, const std::string& program) {
  ContentHash hash;
  hash.add(std::string_view("prospect study cell 1")).add(program);
  for (const ConfigEntry& entry : with_start(configuration.entries, start)) {
    // A map is what it holds, wherever it lies.
    if (entry.path == "simulator.map" && !configuration.map.empty()) continue;
    hash.add(entry.path).add(entry.value);
  }
  if (!configuration.map.empty()) hash.add(file_hash(configuration.map));
  return hash.add(world_hash).add(seed).text();
}

const std::string& StudyPlan::solver(const StudySetup& setup) const {
  return study.kind == Study::Kind::kBenches ? setup.bench.solver : setup.configuration.solver;
}

std::vector<std::string> StudyPlan::values(const StudySetup& setup) const {
  std::vector<std::string> out;
  for (std::size_t a = 0; a < setup.values.size(); ++a) {
    out.push_back(study.grid[a].values[setup.values[a]].value);
  }
  return out;
}

std::string StudyPlan::label(const StudySetup& setup) const {
  std::string text = condition(setup).name;
  const std::vector<std::string> chosen = values(setup);
  for (std::size_t a = 0; a < chosen.size(); ++a) {
    text += (text.empty() ? "" : ", ") + study.grid[a].key + "=" + chosen[a];
  }
  return text.empty() ? "all" : text;
}

StudyPlan plan_study(const Study& study, const Registries& registries, const std::string& program,
                     const std::function<void(const std::string&)>& progress) {
  StudyPlan plan{study, read_setups(study, registries), {}, {}, program};
  if (study.kind == Study::Kind::kBenches) {
    plan_benches(plan, registries, progress);
  } else {
    plan_missions(plan, progress);
  }
  return plan;
}

std::string cell_configuration(const StudyPlan& plan, const StudyCell& cell) {
  return effective_yaml(with_start(plan.setup(cell).configuration.entries, cell.start));
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/study/bench_settings.h"
#include "adapters/missions/study/study.h"
#include "models/types.h"

namespace prospect {

/// A condition at a point of the grid: a way to run missions, or benches.
struct StudySetup {
  std::size_t condition = 0;        ///< Study::conditions
  std::vector<std::size_t> values;  ///< by axis: which of its values
  Configuration configuration;      ///< of missions
  BenchSettings bench;              ///< of benches
};

/// A mission or a bench: a way to run it, a world or a set of problems, a seed.
struct StudyCell {
  /// 16 hexadecimal digits: hash of the effective configuration (of BenchSettings), of what the
  /// world holds (of the problems), of the seed and of the program. Cells with the same name are
  /// the same mission or bench.
  std::string id;
  std::size_t setup = 0;  ///< StudyPlan::setups
  std::size_t input = 0;  ///< Study::inputs
  std::uint64_t seed = 0;
  std::optional<Pose> start;  ///< of Study::drawn_starts
};

struct StudyPlan {
  Study study;
  std::vector<StudySetup> setups;  ///< conditions outermost, the last axis innermost
  /// Of benches: names of the problems of each of Study::inputs.
  std::vector<std::vector<std::string>> problems;
  /// Seeds outermost, setups innermost: a study that is broken off holds whole pairs.
  std::vector<StudyCell> cells;
  std::string program;  ///< that cells are named by: plan_study()

  const StudySetup& setup(const StudyCell& cell) const { return setups[cell.setup]; }
  const StudyCondition& condition(const StudySetup& setup) const {
    return study.conditions[setup.condition];
  }
  /// The back end of a setup.
  const std::string& solver(const StudySetup& setup) const;
  /// The values of the grid's keys, as YAML.
  std::vector<std::string> values(const StudySetup& setup) const;
  /// "without, planner.N=20": the condition, and the values of the grid's keys.
  std::string label(const StudySetup& setup) const;
};

/// All cells of a study. `program` is what its results depend on besides: version, commit,
/// plug-ins. `progress` (may be empty) is told what is being read. Throws InputError for a key or
/// value that the configuration or the bench does not take (`file:line` of the study), for worlds
/// that cannot be read or hold no place for the robot, and for sets of problems that cannot be
/// made.
StudyPlan plan_study(const Study& study, const Registries& registries, const std::string& program,
                     const std::function<void(const std::string&)>& progress = {});

/// The name of a mission of that program: StudyCell::id. `start`: of Study::drawn_starts, where the
/// configuration has none of its own.
std::string cell_name(const Configuration& configuration, const std::optional<Pose>& start,
                      std::uint64_t world_hash, std::uint64_t seed, const std::string& program);

/// The effective configuration of a mission, as config.yaml.
std::string cell_configuration(const StudyPlan& plan, const StudyCell& cell);

}  // namespace prospect

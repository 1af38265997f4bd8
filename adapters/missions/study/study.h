// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prospect {

/// A value of the configuration that a study chooses.
struct StudySetting {
  std::string key;    ///< "planner.weights.w_l"
  std::string value;  ///< YAML on one line
  std::string where;  ///< file:line of the study, for messages
};

/// What cells are run on: a world, or a set of problems.
struct StudyInput {
  std::string name;  ///< as the study names it: the same on every machine
  std::string
      path;  ///< as load_world() or make_problem_set() takes it: files of the study's folder
  std::string where;  ///< file:line
};

struct StudyCondition {
  std::string name;
  std::vector<StudySetting> settings;
};

/// A key that takes each of several values.
struct StudyAxis {
  std::string key;
  std::vector<StudySetting> values;
};

/// What a study file asks for: a mission for each world, seed, condition and point of the grid; or
/// a bench for each set of problems, seed, condition and point of the grid.
struct Study {
  enum class Kind {
    kMissions,  ///< on worlds; keys are those of the configuration
    kBenches    ///< on sets of problems; keys are those of BenchSettings
  };
  Kind kind = Kind::kMissions;
  std::string name;
  std::string file;
  std::string base;  ///< of missions: configuration file; empty: the defaults
  std::vector<StudyInput> inputs;
  std::vector<std::uint64_t> seeds;  ///< of a mission's noise; of a back end
  /// The first is what the others are compared with. At least one; of an empty name if the study
  /// has none.
  std::vector<StudyCondition> conditions;
  std::vector<StudyAxis> grid;  ///< the first value of each is what the others are compared with
  /// Of all cells: keys of the configuration's `mission`; of BenchSettings.
  std::vector<StudySetting> common;
  /// Of missions: seed 1 begins where the world says, each other one where it draws, the same place
  /// for every condition.
  bool drawn_starts = false;
};

/// Reads a study file. Paths in it are relative to it. Throws InputError with every problem at
/// once, `file:line: what; expected what`. Of keys and values of conditions only the form is
/// checked here.
Study read_study(const std::string& path);
/// The same from text; `source` stands for the file.
Study study_from_text(const std::string& text, const std::string& source);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/missions/bench/problem_set.h"

namespace prospect {
namespace {

constexpr std::uint64_t kMostOfARange = 1'000'000;

struct NumberRange {
  std::uint64_t first = 0, last = 0;
};

/// "7" or "1..20".
std::optional<NumberRange> range_of(const std::string& text) {
  NumberRange range;
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) {
    if (!parse_number(text, range.first)) return std::nullopt;
    range.last = range.first;
    return range;
  }
  const bool sound = parse_number(std::string_view(text).substr(0, dots), range.first) &&
                     parse_number(std::string_view(text).substr(dots + 2), range.last) &&
                     range.first <= range.last && range.last - range.first < kMostOfARange;
  return sound ? std::optional(range) : std::nullopt;
}

/// A path of the study's folder, unless it is absolute.
std::string beside(const std::string& file, const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  return (folder / path).lexically_normal().string();
}

/// Collects problems, in the form of StrictYaml.
class StudyReader {
 public:
  StudyReader(StrictYaml yaml, const std::string& file)
      : yaml_(std::move(yaml)), root_(yaml_.root()), file_(file) {}

  Study read() {
    study_.file = file_;
    study_.name = root_.text("study", std::filesystem::path(file_).stem().string(),
                             "Name, for the folder and the page");
    const bool plain = !study_.name.empty() && study_.name.front() != '.' &&
                       study_.name.find_first_of("/\\") == std::string::npos;
    if (!plain) root_.problem("study", "no name for a folder; expected letters, digits, _ and -");
    if (root_.has("problems")) {
      study_.kind = Study::Kind::kBenches;
      read_problem_sets();
      study_.common = settings(root_.map("bench"), "");
    } else {
      const std::string base =
          root_.text("base", "", "Configuration file that all cells begin with");
      if (!base.empty()) study_.base = beside(file_, base);
      read_worlds();
      study_.common = settings(root_.map("mission"), "mission.");
      study_.drawn_starts =
          root_.choice("starts", "world", {"world", "drawn"},
                       "world: where the world says; drawn: where the seed draws, but for seed "
                       "1") == "drawn";
    }
    read_seeds();
    read_conditions();
    read_grid();
    count_cells();
    yaml_.finish();
    return std::move(study_);
  }

 private:
  void read_problem_sets() {
    const std::vector<YamlValue> values =
        root_.values("problems", "Sets of problems, as bench takes them");
    if (values.empty()) root_.problem("problems", "no set; expected a list of sets of problems");
    if (root_.has("worlds")) {
      root_.values("worlds", "Of missions");
      root_.problem("problems", "stands beside 'worlds'; expected one of them");
    }
    std::set<std::string> known;
    for (const YamlValue& value : values) {
      if (!value.is_scalar || value.text.empty()) {
        root_.problem("problems", value.yaml + " is no set of problems; expected a name or a path");
      } else if (value.text == "missions") {
        root_.problem("problems",
                      "'missions' are driven before they are solved; expected a folder that "
                      "`prospect bench --capture` has written, the same for all cells");
      } else if (!known.insert(value.text).second) {
        root_.problem("problems", "'" + value.text + "' twice; expected each set once");
      } else {
        const bool is_name = !builtin_set_summary(value.text).empty();
        const std::string file = beside(file_, value.text);
        std::error_code error;
        // What is not there may be of a plug-in: make_problem_set() has the nearest name.
        const bool is_file = !is_name && std::filesystem::exists(file, error);
        study_.inputs.push_back({value.text, is_file ? file : value.text, value.where});
      }
    }
  }

  void read_worlds() {
    const std::vector<YamlValue> values = root_.values("worlds", "Worlds, as explore takes them");
    if (values.empty())
      root_.problem("worlds", "no world; expected a list of worlds, or of 'problems'");
    std::set<std::string> known;
    const std::vector<std::string> builtin = builtin_world_names();
    for (const YamlValue& value : values) {
      if (!value.is_scalar || value.text.empty()) {
        root_.problem("worlds", value.yaml + " is no world; expected a name or a file");
        continue;
      }
      std::vector<std::string> names;
      const std::string plan = value.text.starts_with("drops:") ? "drops:" : "plan:";
      const bool several =
          value.text.starts_with(plan) && value.text.find("..") != std::string::npos;
      if (several) {
        const std::size_t colon = value.text.find(':', plan.size());
        const std::optional<NumberRange> range = range_of(value.text.substr(
            plan.size(), colon == std::string::npos ? std::string::npos : colon - plan.size()));
        if (!range) {
          root_.problem("worlds", value.yaml + "; expected " + plan + "FIRST..LAST, such as " +
                                      plan + "0..11");
          continue;
        }
        const std::string size = colon == std::string::npos ? "" : value.text.substr(colon);
        for (std::uint64_t n = range->first; n <= range->last; ++n) {
          names.push_back(plan + std::to_string(n) + size);
        }
      } else {
        names.push_back(value.text);
      }
      for (const std::string& name : names) {
        if (!known.insert(name).second) {
          root_.problem("worlds", "'" + name + "' twice; expected each world once");
          continue;
        }
        const bool of_program = name.starts_with(plan) ||
                                std::find(builtin.begin(), builtin.end(), name) != builtin.end();
        // What has no extension is a name, known or not: load_world() has the nearest one.
        const bool is_name = of_program || !std::filesystem::path(name).has_extension();
        study_.inputs.push_back({name, is_name ? name : beside(file_, name), value.where});
      }
    }
  }

  void read_seeds() {
    const std::vector<YamlValue> values = root_.values("seeds", "Seeds: 1..20, or a list");
    if (values.empty()) study_.seeds = {1};
    std::set<std::uint64_t> known;
    for (const YamlValue& value : values) {
      const std::optional<NumberRange> range =
          value.is_scalar ? range_of(value.text) : std::nullopt;
      if (!range) {
        root_.problem("seeds", value.yaml +
                                   " is no seed; expected whole numbers, such as 1..20 or "
                                   "[1, 2, 5..9]");
        continue;
      }
      const std::uint64_t most = std::numeric_limits<int>::max();
      if (study_.kind == Study::Kind::kBenches && range->last > most) {
        root_.problem("seeds", value.yaml + " is no seed of a back end; expected at most " +
                                   std::to_string(most));
        continue;
      }
      for (std::uint64_t n = 0; n <= range->last - range->first; ++n) {
        const std::uint64_t seed = range->first + n;
        if (known.insert(seed).second) {
          study_.seeds.push_back(seed);
        } else {
          root_.problem("seeds", std::to_string(seed) + " twice; expected each seed once");
        }
      }
    }
  }

  void read_conditions() {
    YamlMap conditions = root_.free_map("conditions", "Name: {key: value}");
    for (const std::string& name : conditions.keys()) {
      if (name.empty()) conditions.problem(name, "a condition without a name; expected one");
      study_.conditions.push_back({name, settings(conditions.map(name), "")});
    }
    if (study_.conditions.empty()) study_.conditions.push_back({});
  }

  /// Before any of them is made: a few axes are soon more than memory holds.
  void count_cells() {
    constexpr double kMostSetups = 1e4, kMostCells = 1e6;
    double setups = static_cast<double>(study_.conditions.size());
    for (const StudyAxis& axis : study_.grid) setups *= static_cast<double>(axis.values.size());
    const double cells = setups * static_cast<double>(study_.inputs.size()) *
                         static_cast<double>(study_.seeds.size());
    std::ostringstream counted;
    counted << setups << " setups, " << cells << " cells";
    if (setups > kMostSetups || cells > kMostCells) {
      root_.problem(study_.grid.empty() ? "seeds" : "grid",
                    counted.str() + " in all; expected at most 10000 setups and 1000000 cells");
    }
  }

  void read_grid() {
    YamlMap grid = root_.free_map("grid", "Key: its values");
    for (const std::string& key : grid.keys()) {
      StudyAxis axis{key, {}};
      std::set<std::string> known;
      for (const YamlValue& value : grid.values(key, "Values of the key")) {
        if (!known.insert(value.yaml).second) {
          grid.problem(key, value.yaml + " twice; expected each value once");
        }
        axis.values.push_back({key, value.yaml, value.where});
      }
      if (axis.values.empty()) grid.problem(key, "has no value; expected a list of values");
      for (const StudyCondition& condition : study_.conditions) {
        for (const StudySetting& setting : condition.settings) {
          if (setting.key == key) {
            grid.problem(key, "is set by the condition '" + condition.name +
                                  "', too; expected it in one place");
          }
        }
      }
      study_.grid.push_back(std::move(axis));
    }
  }

  std::vector<StudySetting> settings(YamlMap map, const std::string& before) {
    std::vector<StudySetting> out;
    for (const std::string& key : map.keys()) {
      const std::optional<YamlValue> value = map.value(key, "Of the cells");
      if (value) {
        out.push_back({before + key, value->yaml, value->where});
      } else {
        map.problem(key, "has no value; expected one");
      }
    }
    return out;
  }

  StrictYaml yaml_;
  YamlMap root_;
  std::string file_;
  Study study_;
};

}  // namespace

Study read_study(const std::string& path) {
  return StudyReader(StrictYaml::from_file(path), path).read();
}

Study study_from_text(const std::string& text, const std::string& source) {
  return StudyReader(StrictYaml::from_text(text, source), source).read();
}

}  // namespace prospect

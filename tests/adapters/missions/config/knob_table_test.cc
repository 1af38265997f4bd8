// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "models/knobs.h"
#include "models/make_model.h"
#include "models/range_text.h"
#include "perception/pipeline/perception_pipeline.h"
#include "tests/adapters/box_room.h"

// All knobs of a configuration, one by one, by their descriptions: a new one is tested without a
// line here.
namespace prospect::knob_table_test {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

enum class Kind { kNumber, kDegrees, kInteger, kBoolean, kWord, kNumbers };

struct Knob {
  std::string path, name, unit, sentence;
  Kind kind = Kind::kNumber;
  double min = 0.0, max = 0.0, value = 0.0;  ///< in its unit; value: of what was described
  std::vector<std::string> words;
  std::size_t count = 1;
};

/// Lists what is described, and sets the one at a path.
class Table final : public Knobs {
 public:
  explicit Table(std::string at) : groups_{std::move(at)} {}
  Table(std::string at, std::string path, double value)
      : groups_{std::move(at)}, path_(std::move(path)), value_(value) {}

  void number(const char* name, double& value, Range range, const char* unit,
              const char* sentence) override {
    add({path(name), name, unit, sentence, Kind::kNumber, range.min, range.max, value, {}}, value);
  }
  void degrees(const char* name, double& radians, Range range, const char* sentence) override {
    double value = radians / kRadiansPerDegree;
    add({path(name), name, "deg", sentence, Kind::kDegrees, range.min, range.max, value, {}},
        value);
    if (path(name) == path_) radians = kRadiansPerDegree * value;
  }
  void integer(const char* name, int& value, WholeRange range, const char* unit,
               const char* sentence) override {
    double number = value;
    add({path(name),
         name,
         unit,
         sentence,
         Kind::kInteger,
         double(range.min),
         double(range.max),
         number,
         {}},
        number);
    if (path(name) == path_) value = static_cast<int>(number);
  }
  void boolean(const char* name, bool& value, const char* sentence) override {
    double number = value;
    add({path(name), name, "", sentence, Kind::kBoolean, 0.0, 1.0, number, {}}, number);
    if (path(name) == path_) value = number != 0.0;
  }
  void numbers(const char* name, double* values, std::size_t count, Range range, const char* unit,
               const char* sentence) override {
    Knob knob{path(name), name,      unit,      sentence, Kind::kNumbers,
              range.min,  range.max, values[0], {}};
    knob.count = count;
    add(std::move(knob), values[count - 1]);
  }
  void require(bool, const char*, const char*) override {}

  std::vector<Knob> knobs;

 private:
  void word(const char* name, std::size_t& index, const std::vector<std::string>& words,
            const char* sentence) override {
    auto number = static_cast<double>(index);
    add({path(name), name, "", sentence, Kind::kWord, 0.0, double(words.size()) - 1.0, number,
         words},
        number);
    if (path(name) == path_) index = static_cast<std::size_t>(number);
  }
  void enter(const char* name) override { groups_.push_back(path(name)); }
  void leave() override { groups_.pop_back(); }
  std::string path(const char* name) const { return groups_.back() + '.' + name; }
  void add(Knob knob, double& value) {
    if (knob.path == path_) value = value_;
    knobs.push_back(std::move(knob));
  }

  std::vector<std::string> groups_;
  std::string path_;
  double value_ = 0.0;
};

/// Knobs that are described together: where they stand in a configuration file, with which other
/// settings, how a configuration is described, and who refuses it if it is wrong.
struct Part {
  std::string at;
  std::vector<std::string> settings;
  std::function<void(Knobs&, Configuration&)> describe;
  std::function<void(const Configuration&)> construct;
};

void make_planner(const Configuration& c) {
  Planner(c.robot, c.planner, SolverRegistry().make("nlopt"));
}

void make_simulator(const Configuration& c) {
  static const auto world = std::make_shared<const World>(test::box_room(3.0, 3.0));
  Simulator(world, c.simulator, c.perception);
}

template <typename Shape>
Part shape_part(const std::string& type) {
  return {"robot.shape",
          {"robot.shape.type=" + type},
          [](Knobs& k, Configuration& c) { describe(k, std::get<Shape>(c.robot.shape)); },
          make_planner};
}

std::vector<Part> parts() {
  std::vector<Part> all = {
      {"planner", {}, [](Knobs& k, Configuration& c) { describe(k, c.planner); }, make_planner},
      {"mission.end",
       {},
       [](Knobs& k, Configuration& c) { describe_end(k, c.planner.frontier_planner); },
       make_planner},
      {"mission", {}, [](Knobs& k, Configuration& c) { describe(k, c.mission); }, {}},
      {"guard",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.guard); },
       [](const Configuration& c) {
         Guard(c.robot.model, c.robot.shape, Certifier::options_for(c.robot), c.guard);
       }},
      {"simulator",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.simulator); },
       make_simulator},
      {"perception",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.perception); },
       [](const Configuration& c) { PerceptionPipeline(c.robot.stereo, c.perception); }},
      {"drive", {}, [](Knobs& k, Configuration& c) { describe(k, c.drive.driver); }, {}},
      {"drive.preflight",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.drive.preflight); },
       {}},
      {"drive.ranges", {}, [](Knobs& k, Configuration& c) { describe(k, c.drive.ranges); }, {}},
      {"drive.inbox", {}, [](Knobs& k, Configuration& c) { describe(k, c.drive.inbox); }, {}},
      {"drive.simulator",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.simulated_base); },
       {}},
      {"gazebo", {}, [](Knobs& k, Configuration& c) { describe(k, c.gazebo); }, {}},
      {"robot.stereo",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.robot.stereo); },
       make_planner},
      {"robot.depth",
       {},
       [](Knobs& k, Configuration& c) { describe(k, c.robot.depth); },
       make_planner},
      shape_part<CylinderShape>("cylinder"),
      shape_part<BoxShape>("box"),
  };
  for (const std::string& name : model_names()) {
    all.push_back({"robot.motion",
                   {"robot.model=" + name},
                   [name](Knobs& k, Configuration& c) {
                     ModelParameters parameters = parameters_of(*c.robot.model);
                     describe(k, name, parameters);
                     c.robot.model = make_model(name, parameters);
                   },
                   {}});
  }
  return all;
}

Configuration configuration_of(const Part& part, const std::vector<std::string>& further = {}) {
  std::vector<YamlSetting> settings(part.settings.begin(), part.settings.end());
  settings.insert(settings.end(), further.begin(), further.end());
  return read_configuration("", {}, settings);
}

std::vector<Knob> knobs_of(const Part& part, Configuration c) {
  Table table(part.at);
  part.describe(table, c);
  return table.knobs;
}

/// What is said of a value that is refused; "" if it is not.
std::string refusal(const std::function<void()>& use) {
  try {
    use();
  } catch (const InputError& e) {
    return e.what();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

/// "a: {b: {c: value}}" for a.b.c, with the part's other settings.
std::string yaml_of(const Part& part, const std::string& path, const std::string& value) {
  std::string text, end;
  std::string rest = path;
  for (std::size_t dot; (dot = rest.find('.')) != std::string::npos; rest = rest.substr(dot + 1)) {
    text += rest.substr(0, dot) + ": {";
    end += '}';
  }
  text += rest + ": " + value;
  // Only siblings of the key are set besides: robot.shape.type, robot.model.
  for (const std::string& setting : part.settings) {
    const std::size_t equals = setting.find('=');
    const std::string other = setting.substr(0, equals), word = setting.substr(equals + 1);
    const std::size_t dot = other.rfind('.');
    if (path.starts_with(other.substr(0, dot) + '.') && other.rfind('.') == path.rfind('.')) {
      text += ", " + other.substr(dot + 1) + ": " + word;
    } else {
      text += "}, " + other.substr(dot + 1) + ": " + word;
      end.pop_back();
    }
  }
  return text + end;
}

/// Values that a knob must not have, as text and as a number.
std::vector<std::pair<std::string, double>> wrong_values(const Knob& knob) {
  std::vector<std::pair<std::string, double>> wrong;
  const auto beyond = [](double end) { return std::max(1.0, 0.1 * std::abs(end)); };
  const auto text = [&](double value) {
    if (knob.kind == Kind::kNumbers) {
      std::string list = "[";
      for (std::size_t i = 0; i + 1 < knob.count; ++i) list += exact_text(knob.value) + ", ";
      return list + (std::isnan(value) ? ".nan" : exact_text(value)) + "]";
    }
    if (std::isnan(value)) return std::string(".nan");
    return knob.kind == Kind::kInteger ? std::to_string(static_cast<std::int64_t>(value))
                                       : exact_text(value);
  };
  if (std::isfinite(knob.min)) {
    const double below = knob.min - beyond(knob.min);
    wrong.emplace_back(text(below), below);
  }
  if (std::isfinite(knob.max)) {
    const double above = knob.max + beyond(knob.max);
    wrong.emplace_back(text(above), above);
  }
  wrong.emplace_back(text(kNan), kNan);
  return wrong;
}

bool is_number(const Knob& knob) { return knob.kind != Kind::kBoolean && knob.kind != Kind::kWord; }

TEST(KnobTable, DefaultsLieInTheirRangesAndAgree) {
  std::set<std::string> seen;
  int numbers = 0;
  for (const Part& part : parts()) {
    Configuration c = configuration_of(part);
    KnobCheck check(part.at);
    EXPECT_NO_THROW(part.describe(check, c)) << part.at;
    std::set<std::string> of_part;
    for (const Knob& knob : knobs_of(part, c)) {
      EXPECT_TRUE(of_part.insert(knob.path).second) << knob.path << " is described twice";
      EXPECT_LE(knob.min, knob.value) << knob.path;
      EXPECT_GE(knob.max, knob.value) << knob.path;
      EXPECT_FALSE(knob.sentence.empty()) << knob.path;
      EXPECT_EQ(knob.unit.empty(), !is_number(knob)) << knob.path;
      numbers += is_number(knob);
    }
  }
  EXPECT_GT(numbers, 250);
}

TEST(KnobTable, AConfigurationHasAnEntryForEach) {
  for (const Part& part : parts()) {
    const Configuration c = configuration_of(part);
    for (const Knob& knob : knobs_of(part, c)) {
      const auto entry = std::find_if(c.entries.begin(), c.entries.end(),
                                      [&](const ConfigEntry& e) { return e.path == knob.path; });
      ASSERT_NE(entry, c.entries.end()) << knob.path;
      EXPECT_EQ(entry->unit, knob.unit) << knob.path;
      EXPECT_EQ(entry->description, knob.sentence) << knob.path;
      EXPECT_FALSE(entry->range.empty()) << knob.path;
      EXPECT_EQ(entry->value, entry->default_value) << knob.path;
    }
  }
}

TEST(KnobTable, WhatIsOutOfRangeIsOneLineThatNamesIt) {
  for (const Part& part : parts()) {
    const Configuration sound = configuration_of(part);
    for (const Knob& knob : knobs_of(part, sound)) {
      if (!is_number(knob)) continue;
      for (const auto& [text, value] : wrong_values(knob)) {
        SCOPED_TRACE(knob.path + " = " + text);
        const auto one_line = [&](const std::string& said, const std::string& where,
                                  const std::string& name) {
          EXPECT_TRUE(said.starts_with(where)) << said;
          EXPECT_THAT(said, HasSubstr(name));
          // A line for each that does not fit.
          std::istringstream lines(said);
          for (std::string line; std::getline(lines, line);) {
            EXPECT_THAT(line, HasSubstr("; expected "));
          }
        };
        const std::string yaml = yaml_of(part, knob.path, text);
        one_line(refusal([&] { configuration_from_text(yaml, "f.yaml"); }),
                 "f.yaml:1: ", knob.path + ": ");
        one_line(refusal([&] { configuration_of(part, {knob.path + "=" + text}); }),
                 "--set " + knob.path + "=", knob.path + ": ");
        if (knob.kind == Kind::kInteger && std::isnan(value)) continue;
        if (part.at == "robot.motion") continue;  // made anew by what describes it
        Configuration c = sound;
        Table spoil(part.at, knob.path, value);
        part.describe(spoil, c);
        const std::string below = knob.path.substr(part.at.size() + 1);
        KnobCheck check("owner");
        one_line(refusal([&] { part.describe(check, c); }), "owner: " + below + " is ", below);
        if (part.construct) one_line(refusal([&] { part.construct(c); }), "", knob.name + " is ");
      }
    }
  }
}

TEST(KnobTable, SwitchesAndWordsAreWhatTheyMayBe) {
  for (const Part& part : parts()) {
    for (const Knob& knob : knobs_of(part, configuration_of(part))) {
      if (is_number(knob)) continue;
      for (const char* wrong : {"2", "nonsense", ".nan"}) {
        const std::string said =
            refusal([&] { configuration_of(part, {knob.path + "=" + wrong}); });
        EXPECT_THAT(said, HasSubstr(knob.path + ": is '" + wrong + "'"));
        EXPECT_THAT(said, HasSubstr("; expected "));
        EXPECT_EQ(said.find('\n'), std::string::npos) << said;
      }
    }
  }
}

// Each knob alone a little off its default: the configuration that is read holds that value, and
// all others are as they were.
TEST(KnobTable, EachReachesItsMember) {
  for (const Part& part : parts()) {
    const std::vector<Knob> before = knobs_of(part, configuration_of(part));
    for (const Knob& knob : before) {
      double value = 0.0;
      std::string text;
      if (knob.kind == Kind::kBoolean) {
        value = 1.0 - knob.value;
        text = value != 0.0 ? "true" : "false";
      } else if (knob.kind == Kind::kWord) {
        value = knob.value > 0.0 ? 0.0 : 1.0;
        text = knob.words.at(static_cast<std::size_t>(value));
      } else {
        const double room = std::isfinite(knob.max) ? knob.max - knob.value : 1.0;
        const double scale = std::max(std::abs(knob.value), 1e-3);
        double step = room > 0.0 ? std::min(0.5 * room, 0.01 * scale) : -0.01 * scale;
        if (knob.kind == Kind::kInteger) step = room > 0.0 ? 1.0 : -1.0;
        // The other way where another knob's default bounds it.
        const auto taken = [&](double v) {
          return knob.count > 1 || refusal([&] {
                                     configuration_of(part, {knob.path + "=" + exact_text(v)});
                                   }).empty();
        };
        value = taken(knob.value + step) ? knob.value + step : knob.value - step;
        text = exact_text(value);
        if (knob.kind == Kind::kNumbers) {
          text = "[" + text;
          for (std::size_t i = 1; i < knob.count; ++i) text += ", " + exact_text(value);
          text += "]";
        }
      }
      SCOPED_TRACE(knob.path + " = " + text);
      Configuration c;
      ASSERT_NO_THROW(c = configuration_of(part, {knob.path + "=" + text}));
      const std::vector<Knob> after = knobs_of(part, c);
      ASSERT_EQ(after.size(), before.size());
      for (std::size_t i = 0; i < after.size(); ++i) {
        EXPECT_NEAR(after[i].value, after[i].path == knob.path ? value : before[i].value,
                    1e-12 * std::abs(before[i].value) + 1e-300)
            << after[i].path;
      }
    }
  }
}

TEST(KnobTable, AMisspeltOneIsToldTheNearest) {
  for (const Part& part : parts()) {
    for (const Knob& knob : knobs_of(part, configuration_of(part))) {
      const std::string said =
          refusal([&] { configuration_of(part, {knob.path + knob.name.back() + "=1"}); });
      EXPECT_THAT(said, HasSubstr("unknown key '" + knob.path + knob.name.back() +
                                  "' (did you mean '" + knob.name + "'?); expected one of: "));
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
  }
}

TEST(KnobTable, WhatMustAgreeIsSaidAlikeByFileAndConstructor) {
  const Configuration sound = read_configuration("");
  const auto planner = [&](const std::function<void(PlannerParameters&)>& change) {
    Configuration c = sound;
    change(c.planner);
    return refusal([&] { make_planner(c); });
  };
  const auto file = [](const std::string& setting) {
    return refusal([&] { read_configuration("", {}, {setting}); });
  };
  EXPECT_EQ(planner([](auto& p) { p.M = 21; }),
            "planner: M: more knots than stages; expected at most N");
  EXPECT_EQ(file("planner.M=21"),
            "--set planner.M=21: planner.M: more knots than stages; expected at most N");
  EXPECT_EQ(planner([](auto& p) { p.d_des = 0.01; }),
            "planner: d_des: d_des <= d_safe; expected more");
  EXPECT_EQ(file("planner.d_des=0.01"),
            "--set planner.d_des=0.01: planner.d_des: d_des <= d_safe; expected more");
  EXPECT_EQ(planner([](auto& p) { p.committed = 6.0; }),
            "planner: committed: longer than the horizon; expected at most N dt");
  EXPECT_EQ(file("planner.committed=6"),
            "--set planner.committed=6: planner.committed: longer than the horizon; expected at "
            "most N dt");
  EXPECT_EQ(planner([](auto& p) { p.visibility.r_max = 0.5, p.visibility.r_min = 0.6; }),
            "planner: visibility.r_max: r_max <= r_min; expected more");
  // What the robot has a part in.
  EXPECT_THAT(file("planner.frontiers.view_margin=5"), HasSubstr("planner: frontier utility: "));
}

/// What a robot knows of a room of 3 x 3 m that it stands in, in voxels of `resolution` [m].
Belief tiny_belief(double resolution) {
  Belief belief;
  const int n = std::max(3, static_cast<int>(std::lround(3.0 / resolution)));
  VoxelGrid voxels(GridFrame{resolution, 0, 0, n, n}, 0.0, 0.6);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const bool wall = i == 0 || j == 0 || i == n - 1;
      const bool seen = j < n - n / 3;
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        voxels.set(i, j, k,
                   wall   ? CellState::kOccupied
                   : seen ? CellState::kFree
                          : CellState::kUnknown);
      }
    }
  }
  belief.pose.position = {1.5, 1.0, 0.0};
  belief.ground = std::make_shared<const GroundMap>(project(voxels, {0.1, 0.5}, 8));
  belief.voxels = std::make_shared<const VoxelGrid>(std::move(voxels));
  belief.octree = std::make_shared<const octomap::OcTree>(resolution);
  LandmarkMap map;
  for (int l = 0; l < 40; ++l) {
    Landmark& landmark = map.landmarks.emplace_back();
    landmark.id = static_cast<std::uint64_t>(l);
    landmark.position = {0.1, 0.3 + 0.05 * l, 0.4};
  }
  belief.landmarks = std::make_shared<const LandmarkMap>(std::move(map));
  belief.tracked_features = 40;
  belief.set_stamps(1.0);
  return belief;
}

/// Most memory that this process has held since the last call [MB]; 0: the system does not tell.
double peak_memory() {
  double megabytes = 0.0;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) megabytes = std::stod(line.substr(6)) / 1024.0;
  }
  std::ofstream("/proc/self/clear_refs") << "5";
  return megabytes;
}

/// Whether a planner has a part in it, and of perception what it sees of it.
bool is_planned_with(const Part& part, const Knob& knob) {
  if (!is_number(knob) || knob.path == "planner.threads") return false;
  if (part.at == "perception") {
    return knob.path == "perception.mapping.resolution" || knob.name == "z_min" ||
           knob.name == "z_max";
  }
  return part.at.starts_with("planner") || part.at.starts_with("robot") || part.at == "mission.end";
}

/// "KEY=VALUE" of the ends of its range.
std::vector<std::string> ends_of(const Knob& knob) {
  std::vector<std::string> ends;
  for (const double end : {knob.min, knob.max}) {
    if (!std::isfinite(end)) continue;
    std::string text = exact_text(end);
    if (knob.kind == Kind::kNumbers) text = "[" + text + ", " + text + ", " + text + "]";
    ends.push_back(knob.path + "=" + text);
  }
  return ends;
}

/// Steps that are planned with settings, or settings that are refused.
class Tries {
 public:
  /// What is read and judged together can be planned with, in a memory that follows what is known
  /// and in bounded time, or is refused in one line.
  void operator()(const Part& part, std::vector<std::string> settings) {
    std::string trace = part.at;
    const bool alone = settings.size() == 1;
    bool polished = false;
    for (const std::string& setting : settings) {
      trace += " " + setting;
      polished = polished || setting.starts_with("planner.polished=");
    }
    SCOPED_TRACE(trace);
    // As few seeds are polished as can be: what is cheap at each end is not looked at.
    if (!polished) settings.push_back("planner.polished=0");
    Configuration c;
    const std::string said = refusal([&] {
      c = configuration_of(part, settings);
      check_drives(c);
    });
    if (!said.empty()) {
      ++refused;
      // A line for each that does not fit.
      std::istringstream lines(said);
      for (std::string line; std::getline(lines, line);) {
        EXPECT_THAT(line, HasSubstr("; expected "));
      }
      return;
    }
    ++planned;
    const std::clock_t begun = std::clock();
    Planner planner(c.robot, c.planner, SolverRegistry().make("nlopt"));
    const Plan plan = planner.plan(tiny_belief(c.perception.mapping.resolution));
    EXPECT_EQ(plan.fault, PlanFault::kNone) << plan.detail;
    // Two may leave nothing that can be seen.
    if (alone) {
      EXPECT_EQ(planner.step()->landmarks.empty(), c.planner.max_landmarks == 0);
    }
    constexpr double kMostSeconds = 10.0, kMostMegabytes = 500.0;
    EXPECT_LT(static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC, kMostSeconds);
    EXPECT_LT(peak_memory() - before_, kMostMegabytes);
  }
  int planned = 0, refused = 0;

 private:
  const double before_ = (peak_memory(), peak_memory());
};

TEST(KnobTable, WithEachEndOfItsRangeAStepIsPlannedOrItIsRefused) {
  Tries tries;
  for (const Part& part : parts()) {
    for (const Knob& knob : knobs_of(part, configuration_of(part))) {
      if (!is_planned_with(part, knob)) continue;
      for (const std::string& end : ends_of(knob)) tries(part, {end});
    }
  }
  EXPECT_GT(tries.planned, 200);
  EXPECT_LT(tries.refused, 60);
}

/// Names that the code uses together: those of each function of the engine and the models. They
/// are knobs of the same arithmetic, or may be.
std::vector<std::set<std::string>> used_together(const std::set<std::string>& names) {
  namespace fs = std::filesystem;
  std::set<fs::path> files;
  for (const char* room : {"engine", "models"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(std::string(PROSPECT_SOURCE_DIR) + "/" + room)) {
      const std::string name = entry.path().filename();
      if (name.ends_with(".cc") && !name.ends_with("_knobs.cc")) files.insert(entry.path());
    }
  }
  std::vector<std::set<std::string>> groups;
  for (const fs::path& path : files) {
    std::ifstream file(path);
    std::set<std::string> used;
    for (std::string line; std::getline(file, line);) {
      std::string word;
      for (const char c : line.substr(0, line.find("//")) + ' ') {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
          word += c;
          continue;
        }
        if (names.contains(word)) used.insert(word);
        word.clear();
      }
      if (!line.starts_with('}')) continue;
      if (used.size() > 1) groups.push_back(used);
      used.clear();
    }
  }
  return groups;
}

// Two knobs at ends of their ranges that a function uses together: a sample of them, the same each
// time. PROSPECT_KNOB_PAIRS=N: each Nth pair of ends; 1: all (10 minutes).
TEST(KnobTable, WithTwoEndsThatShareArithmeticAStepIsPlannedOrTheyAreRefused) {
  std::map<std::string, std::vector<std::pair<Part, Knob>>> by_name;
  std::set<std::string> names;
  for (const Part& part : parts()) {
    for (const Knob& knob : knobs_of(part, configuration_of(part))) {
      if (!is_planned_with(part, knob)) continue;
      by_name[knob.name].emplace_back(part, knob);
      names.insert(knob.name);
    }
  }
  std::set<std::pair<std::string, std::string>> pairs;
  for (const std::set<std::string>& group : used_together(names)) {
    for (const std::string& a : group) {
      for (const std::string& b : group) {
        if (a < b) pairs.emplace(a, b);
      }
    }
  }
  const auto is_pair = [&](const char* a, const char* b) { return pairs.contains({a, b}); };
  EXPECT_TRUE(is_pair("N", "dt") && is_pair("max_range", "resolution")) << pairs.size();
  const char* const asked = std::getenv("PROSPECT_KNOB_PAIRS");
  constexpr int kEvery = 97;
  const int every = asked != nullptr ? std::max(1, std::atoi(asked)) : kEvery;
  Tries tries;
  int number = 0;
  for (const auto& [a, b] : pairs) {
    for (const auto& [part_a, knob_a] : by_name.at(a)) {
      for (const auto& [part_b, knob_b] : by_name.at(b)) {
        // One robot has one shape and one model.
        if (part_a.at == part_b.at && part_a.settings != part_b.settings) continue;
        Part both = part_a;
        both.settings.insert(both.settings.end(), part_b.settings.begin(), part_b.settings.end());
        for (const std::string& end_a : ends_of(knob_a)) {
          for (const std::string& end_b : ends_of(knob_b)) {
            if (number++ % every == 0) tries(both, {end_a, end_b});
          }
        }
      }
    }
  }
  RecordProperty("pairs", number);
  EXPECT_GT(tries.planned, 10);
  EXPECT_GT(tries.refused, 1);
}

// Two that share arithmetic: the keys, the numbers, and what would fit.
TEST(KnobTable, WhatDoesNotFitTogetherIsSaidWithItsNumbers) {
  const auto said = [](const std::vector<YamlSetting>& settings) {
    return refusal([&] { check_drives(read_configuration("", {}, settings)); });
  };
  EXPECT_THAT(said({"robot.depth.max_range=1000"}),
              HasSubstr("robot.depth.max_range is 1000 m, 10000 voxels at a resolution of 0.1 "
                        "m; expected 1 to 200 voxels: 0.1 to 20 m, or a resolution from 5 to "
                        "1000 m"));
  EXPECT_THAT(said({"perception.mapping.resolution=1", "robot.depth.max_range=0.5"}),
              HasSubstr("robot.depth.max_range is 0.5 m"));
  EXPECT_THAT(said({"perception.mapping.resolution=0.02", "perception.mapping.z_max=400"}),
              HasSubstr("are 20015 layers at a resolution of 0.02 m; expected at most 10000"));
  EXPECT_THAT(said({"perception.mapping.z_max=0.4"}),
              HasSubstr("the body is at heights from 0.1 to 0.5 m; expected it between"));
  EXPECT_THAT(
      said({"robot.model=multirotor", "perception.mapping.resolution=0.02", "planner.d_des=5"}),
      HasSubstr("planner.d_des is 5 m: "));
  EXPECT_EQ(said({"perception.mapping.resolution=0.02", "planner.d_des=5"}), "");
  EXPECT_EQ(said({"perception.mapping.resolution=1"}), "");
}

}  // namespace
}  // namespace prospect::knob_table_test

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/builtin_worlds.h"

namespace prospect::study_plan_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

StudyPlan plan_of(const std::string& text, const std::string& program = "1 abc") {
  return plan_study(study_from_text(text, "s.yaml"), {}, program);
}

std::vector<std::string> ids(const StudyPlan& plan) {
  std::vector<std::string> all;
  for (const StudyCell& cell : plan.cells) all.push_back(cell.id);
  return all;
}

TEST(StudyPlan, HasACellForEachWorldSeedConditionAndPointOfTheGrid) {
  const StudyPlan plan = plan_of(
      "worlds: [office, corridor]\nseeds: 1..2\n"
      "conditions: {with: {}, without: {planner.weights.w_l: 0}}\n"
      "grid: {planner.solver: [nlopt, hybrid], planner.N: [12, 20]}\n"
      "mission: {time_limit: 7}\n");
  ASSERT_EQ(plan.setups.size(), 8U);
  ASSERT_EQ(plan.cells.size(), 32U);
  EXPECT_EQ(plan.label(plan.setups[0]), "with, planner.solver=nlopt, planner.N=12");
  EXPECT_EQ(plan.label(plan.setups[7]), "without, planner.solver=hybrid, planner.N=20");
  EXPECT_EQ(plan.setups[7].configuration.planner.weights.visible_features, 0.0);
  EXPECT_EQ(plan.setups[7].configuration.solver, "hybrid");
  EXPECT_EQ(plan.setups[7].configuration.mission.time_limit, 7.0);
  EXPECT_EQ(plan.cells[15].seed, 1U) << "whole pairs first";
  EXPECT_EQ(plan.cells[16].seed, 2U);
  const std::vector<std::string> names = ids(plan);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 32U);
}

TEST(StudyPlan, IsCountedBeforeItIsMade) {
  std::string grid, values;
  for (int n = 10; n < 40; ++n) values += (values.empty() ? "" : ", ") + std::to_string(n);
  for (const char* key : {"N", "w_a", "w_b", "w_c", "w_d", "w_e", "w_f"}) {
    grid += (grid.empty() ? "" : ", ") + ("planner." + std::string(key)) + ": [" + values + "]";
  }
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      study_from_text(text, "s.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("worlds: office\ngrid: {" + grid + "}\n"),
              HasSubstr("s.yaml:2: grid: 2.187e+10 setups"));
  EXPECT_THAT(refusal("worlds: [office, loop]\nseeds: 1..900000\n"),
              HasSubstr("s.yaml:2: seeds: 1 setups, 1.8e+06 cells"));
}

TEST(StudyPlan, ARangeOfSeedsIsAWorldEach) {
  const auto names = [](const std::string& worlds) {
    std::vector<std::string> all;
    const Study study = study_from_text("worlds: [" + worlds + "]\n", "s.yaml");
    for (const StudyInput& input : study.inputs) all.push_back(input.name);
    return all;
  };
  EXPECT_THAT(names("\"plan:3..4\", office"), ElementsAre("plan:3", "plan:4", "office"));
  EXPECT_THAT(names("\"drops:0..2\""), ElementsAre("drops:0", "drops:1", "drops:2"));
  EXPECT_THAT(names("\"drops:8..9:2x3\""), ElementsAre("drops:8:2x3", "drops:9:2x3"));
  EXPECT_THROW(names("\"drops:9..8\""), InputError);
  EXPECT_THROW(names("\"drops:1..\""), InputError);
  EXPECT_THROW(names("\"drops:1..3\", \"drops:2\""), InputError) << "the same world twice";
}

TEST(StudyPlan, ACellIsNamedByWhatItsMissionDependsOn) {
  const std::string text = "worlds: office\nconditions: {a: {planner.N: 12}}\n";
  const std::string id = ids(plan_of(text)).at(0);
  EXPECT_EQ(id.size(), 16U);
  EXPECT_EQ(ids(plan_of(text)).at(0), id);
  // Names of the study and of a condition say nothing of the mission, nor does what is added.
  EXPECT_EQ(ids(plan_of("study: x\nworlds: [office, corridor]\nconditions: {b: {planner.N: 12}}\n"))
                .at(0),
            id);
  EXPECT_NE(ids(plan_of("worlds: office\nconditions: {a: {planner.N: 13}}\n")).at(0), id);
  EXPECT_NE(ids(plan_of("worlds: corridor\nconditions: {a: {planner.N: 12}}\n")).at(0), id);
  EXPECT_NE(ids(plan_of(text + "seeds: 2\n")).at(0), id);
  EXPECT_NE(ids(plan_of(text, "1 abd")).at(0), id);
}

TEST(StudyPlan, AWorldIsWhatItHolds) {
  const std::string folder = ::testing::TempDir() + "study_plan_worlds";
  std::filesystem::create_directories(folder);
  const auto id_of_world = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder + "/" + name) << text;
    return ids(plan_of("worlds: " + folder + "/" + name + "\n")).at(0);
  };
  const std::string text = builtin_world_text("corridor");
  const std::string first = id_of_world("a.yaml", text);
  EXPECT_EQ(id_of_world("b.yaml", text + "\n# the same\n"), first);
  EXPECT_EQ(ids(plan_of("worlds: corridor\n")).at(0), first);
  std::string lower = text;
  const std::string height = "wall_height: ";
  const std::size_t at = lower.find(height);
  ASSERT_NE(at, std::string::npos);
  lower.replace(at, lower.find('\n', at) - at, height + "1.5");
  EXPECT_NE(id_of_world("a.yaml", lower), first);
  std::filesystem::remove_all(folder);
}

TEST(StudyPlan, SeedsDrawStartsAlikeForAllConditions) {
  const StudyPlan plan = plan_of(
      "worlds: office\nseeds: 1..3\nstarts: drawn\nconditions: {a: {}, b: {planner.N: 12}}\n");
  ASSERT_EQ(plan.cells.size(), 6U);
  EXPECT_FALSE(plan.cells[0].start) << "seed 1: where the world says";
  ASSERT_TRUE(plan.cells[2].start && plan.cells[3].start && plan.cells[4].start);
  EXPECT_EQ(plan.cells[2].start->position, plan.cells[3].start->position);
  EXPECT_NE(plan.cells[2].start->position, plan.cells[4].start->position);
  EXPECT_THAT(cell_configuration(plan, plan.cells[2]), HasSubstr("  start: ["));
  const Configuration read =
      configuration_from_text(cell_configuration(plan, plan.cells[2]), "cell");
  ASSERT_TRUE(read.world.start);
  EXPECT_EQ(read.world.start->position.x(), plan.cells[2].start->position.x());
}

TEST(StudyPlan, ABenchIsNamedByBackEndProblemsAndSeed) {
  const std::string text = "problems: zoo\nconditions: {a: {solver: hybrid}}\n";
  const StudyPlan plan = plan_of(text + "grid: {deadline: [0, 0.1]}\nseeds: 1..2\n");
  ASSERT_EQ(plan.cells.size(), 4U);
  EXPECT_EQ(plan.setups[1].bench.deadline, 0.1);
  EXPECT_EQ(plan.problems.at(0).at(0), "Rosenbrock");
  const std::vector<std::string> names = ids(plan);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 4U);
  EXPECT_EQ(ids(plan_of(text)).at(0), names[0]) << "a default that is written out is the same";
  EXPECT_NE(ids(plan_of(text, "1 abd")).at(0), names[0]);
  EXPECT_NE(ids(plan_of("problems: zoo\nconditions: {a: {solver: hybrid, options.candidates: "
                        "20}}\n"))
                .at(0),
            names[0]);
}

TEST(StudyPlan, ASetOfProblemsIsWhatItsFilesHold) {
  const std::string folder = ::testing::TempDir() + "study_plan_problems";
  std::filesystem::create_directories(folder);
  const auto id_of_set = [&](const std::string& name, const std::string& objective) {
    std::ofstream(folder + "/" + name)
        << R"({"problems": [{"name": "p", "n": 1, "x0": [1], "objective": ")" + objective +
               R"(", "inequalities_nonneg": [], "equalities_zero": [], "lower": [-2], "upper": [2]}]})";
    return ids(plan_of("problems: " + folder + "/" + name + "\n")).at(0);
  };
  // The objectives are alike where a fingerprint looks: at the start, and in the middle.
  const std::string first = id_of_set("a.json", "x1^2");
  EXPECT_EQ(id_of_set("b.json", "x1^2"), first);
  EXPECT_NE(id_of_set("a.json", "x1^4"), first);
  std::filesystem::remove_all(folder);
}

TEST(StudyPlan, SaysInTheStudyWhatABenchDoesNotTake) {
  try {
    plan_of("problems: zoo\nconditions:\n  a: {solver: hybird}\n  b: {deadline: soon}\n");
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_THAT(error.lines(), ElementsAre(HasSubstr("s.yaml:3: solver: unknown solver 'hybird'"),
                                           HasSubstr("s.yaml:4: deadline: is 'soon'")));
  }
  try {
    plan_of("study: x\nproblems: zoom\n");
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_THAT(error.lines(), ElementsAre(HasSubstr("s.yaml:2: problems: problem set 'zoom'")));
  }
}

TEST(StudyPlan, SaysInTheStudyWhatTheConfigurationDoesNotTake) {
  try {
    plan_of("worlds: office\nconditions:\n  a: {planner.weigths.w_l: 0}\n  b: {planner.N: many}\n");
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_THAT(error.lines(), ElementsAre(HasSubstr("s.yaml:3: unknown key 'planner.weigths"),
                                           HasSubstr("s.yaml:4: ")));
  }
  EXPECT_THROW(plan_of("worlds: offic\n"), InputError);
}

}  // namespace
}  // namespace prospect::study_plan_test

// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect::study_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> problems_of(const std::string& text) {
  try {
    study_from_text(text, "study.yaml");
  } catch (const InputError& error) {
    return error.lines();
  }
  return {};
}

TEST(Study, IsWhatTheFileSays) {
  const Study study = study_from_text(
      "study: weights\n"
      "base: ../config.yaml\n"
      "worlds: [office, \"plan:0..2\", ../maps/lab.yaml, \"plan:7..8:20x10\"]\n"
      "seeds: [1..3, 9]\n"
      "conditions: {with: {}, without: {planner.weights.w_l: 0, robot.model: holonomic}}\n"
      "grid: {planner.solver: [nlopt, hybrid], planner.N: [12, 20]}\n"
      "mission: {time_limit: 300}\n"
      "starts: drawn\n",
      "/a/b/study.yaml");
  EXPECT_EQ(study.name, "weights");
  EXPECT_EQ(study.base, "/a/config.yaml");
  std::vector<std::string> names, paths;
  for (const StudyInput& world : study.inputs) {
    names.push_back(world.name);
    paths.push_back(world.path);
  }
  EXPECT_THAT(names, ElementsAre("office", "plan:0", "plan:1", "plan:2", "../maps/lab.yaml",
                                 "plan:7:20x10", "plan:8:20x10"));
  EXPECT_EQ(paths[0], "office");
  EXPECT_EQ(paths[4], "/a/maps/lab.yaml");
  EXPECT_THAT(study.seeds, ElementsAre(1, 2, 3, 9));
  ASSERT_EQ(study.conditions.size(), 2U);
  EXPECT_EQ(study.conditions[0].name, "with");
  ASSERT_EQ(study.conditions[1].settings.size(), 2U);
  EXPECT_EQ(study.conditions[1].settings[0].key, "planner.weights.w_l");
  EXPECT_EQ(study.conditions[1].settings[0].value, "0");
  EXPECT_EQ(study.conditions[1].settings[0].where, "/a/b/study.yaml:5");
  ASSERT_EQ(study.grid.size(), 2U);
  EXPECT_EQ(study.grid[1].values[1].value, "20");
  EXPECT_EQ(study.common.at(0).key, "mission.time_limit");
  EXPECT_TRUE(study.drawn_starts);
}

TEST(Study, NeedsWorldsOnly) {
  const Study study = study_from_text("worlds: office\n", "lab.yaml");
  EXPECT_EQ(study.name, "lab");
  EXPECT_THAT(study.seeds, ElementsAre(1));
  ASSERT_EQ(study.conditions.size(), 1U);
  EXPECT_TRUE(study.conditions[0].settings.empty());
  EXPECT_FALSE(study.drawn_starts);
}

TEST(Study, OfProblemsHasSetsAndSettingsOfABench) {
  const Study study = study_from_text(
      "problems: [zoo, set_of_a_plugin, missing.h5]\n"
      "seeds: 1..2\n"
      "conditions: {a: {solver: \"nlopt:LD_SLSQP\"}, b: {solver: hybrid, options.candidates: 20}}\n"
      "grid: {deadline: [0.02, 0.1]}\n"
      "bench: {max_evaluations: 500}\n",
      "/a/b/study.yaml");
  EXPECT_EQ(study.kind, Study::Kind::kBenches);
  ASSERT_EQ(study.inputs.size(), 3U);
  EXPECT_EQ(study.inputs[0].path, "zoo");
  EXPECT_EQ(study.inputs[1].path, "set_of_a_plugin") << "only a plug-in knows";
  EXPECT_EQ(study.common.at(0).key, "max_evaluations");
  EXPECT_EQ(study.conditions[1].settings[1].key, "options.candidates");
  const std::string folder = ::testing::TempDir() + "study_test_problems";
  std::filesystem::create_directories(folder + "/lab");
  EXPECT_EQ(study_from_text("problems: lab\n", folder + "/study.yaml").inputs[0].path,
            folder + "/lab")
      << "a folder beside the study, wherever the program is started";
  std::filesystem::remove_all(folder);
}

TEST(Study, OfProblemsRefusesWhatIsOfMissions) {
  EXPECT_THAT(problems_of("problems: [zoo, zoo, missions]\nworlds: office\nstarts: drawn\n"
                          "mission: {time_limit: 3}\nseeds: 5000000000\n"),
              ElementsAre(HasSubstr("study.yaml:1: problems: stands beside 'worlds'"),
                          HasSubstr("study.yaml:1: problems: 'zoo' twice"),
                          HasSubstr("`prospect bench --capture`"),
                          HasSubstr("study.yaml:3: unknown key 'starts'"),
                          HasSubstr("study.yaml:4: unknown key 'mission'"),
                          HasSubstr("study.yaml:5: seeds: 5000000000 is no seed of a back end")));
  EXPECT_THAT(problems_of("problems: []\n"), ElementsAre(HasSubstr("no set; expected")));
  EXPECT_THAT(problems_of("worlds: office\nbench: {deadline: 1}\n"),
              ElementsAre(HasSubstr("unknown key 'bench'")));
}

TEST(Study, KeepsListsAndMappingsAsValues) {
  const Study study = study_from_text(
      "worlds: office\nconditions: {a: {world.start: [1, -2.5, 90], x: {y: \"a, b\"}}}\n",
      "s.yaml");
  EXPECT_EQ(study.conditions[0].settings[0].value, "[1, -2.5, 90]");
  EXPECT_EQ(study.conditions[0].settings[1].value, "{y: \"a, b\"}");
}

TEST(Study, SaysAllThatIsWrongAndWhere) {
  const std::vector<std::string> lines = problems_of(
      "wrlds: [office]\n"
      "worlds: [\"plan:5..2\", office, office]\n"
      "seeds: [3..1, x]\n"
      "conditions: {a: {planner.N: 3, planner.M: }}\n"
      "grid: {planner.N: [1, 1], planner.K: []}\n"
      "starts: somewhere\n");
  EXPECT_THAT(lines,
              ElementsAre(HasSubstr("study.yaml:1: unknown key 'wrlds' (did you mean 'worlds'?)"),
                          HasSubstr("study.yaml:2: worlds: \"plan:5..2\"; expected plan:FIRST"),
                          HasSubstr("study.yaml:2: worlds: 'office' twice"),
                          HasSubstr("study.yaml:3: seeds: 3..1 is no seed"),
                          HasSubstr("study.yaml:3: seeds: x is no seed"),
                          HasSubstr("study.yaml:4: conditions.a.planner.M: has no value"),
                          HasSubstr("study.yaml:5: grid.planner.N: 1 twice"),
                          HasSubstr("study.yaml:5: grid.planner.N: is set by the condition 'a'"),
                          HasSubstr("study.yaml:5: grid.planner.K: has no value"),
                          HasSubstr("study.yaml:6: starts: is 'somewhere'")));
}

TEST(Study, RefusesNoWorldsAndNamesThatAreNoFolder) {
  EXPECT_THAT(problems_of("seeds: 1\n"), ElementsAre(HasSubstr("no world")));
  EXPECT_THAT(problems_of("study: a/b\nworlds: office\n"),
              ElementsAre(HasSubstr("no name for a folder")));
}

}  // namespace
}  // namespace prospect::study_test

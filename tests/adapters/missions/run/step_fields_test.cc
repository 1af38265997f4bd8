// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/step_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/log/step_messages.h"
#include "adapters/missions/run/step_row.h"
#include "adapters/views/report/report.h"
#include "adapters/views/report/step_table.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::step_fields_test {
namespace {

/// One that lacks nothing.
StepRecord full_step() {
  StepRecord s = synthetic_run(21).steps[20];
  s.goal = Eigen::Vector2d(4.5, -0.25);
  s.goal_yaw = 0.75;
  s.task = TaskKind::kGoTo;
  s.guard_stops = 2;
  s.guard_reason = GuardReason::kSlowZone;
  s.true_pose.position.z() = 0.125;
  s.estimated_pose.position.z() = -0.125;
  s.clearance = std::numeric_limits<double>::infinity();
  s.weights = {{"visible_features", 8.0, 1.0625}, {"exploration_gain", -1.0, 0.5}};
  s.features_weight = 1.0625;
  s.map_frame = MapFrameRecord{{{3.0, -1.0, 0.0}, 0.5}, 2, 1, 3.25, -0.5, "SLAM"};
  return s;
}

/// The names of the fields of a table that are there once a step.
std::set<std::string> names_in(StepTables table) {
  std::set<std::string> names;
  for (const StepField& field : step_fields()) {
    if (field.in(table) && field.per == FieldPer::kStep) names.emplace(field.name);
  }
  return names;
}

TEST(StepFields, TheReferencePageIsTheTable) {
  std::ifstream file(std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/report.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find("<!-- step fields -->\n" + step_field_table() + "<!-- end -->"),
            std::string::npos)
      << step_field_table();
}

TEST(StepFields, EachHasANameASentenceAndAPlace) {
  std::set<std::string_view> names;
  std::set<int> places;
  for (const StepField& field : step_fields()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_FALSE(field.sentence.empty()) << field.name;
    if (field.log_place > 0) {
      EXPECT_TRUE(places.insert(field.log_place).second) << field.name;
    }
  }
  EXPECT_EQ(*places.rbegin(), static_cast<int>(places.size())) << "one is missing";
}

TEST(StepFields, TheColumnsOfStepsCsvAreItsFields) {
  const StepRecord s = full_step();
  const StepColumns columns = step_columns({s});
  const StepTable table = StepTable::parse(step_header(columns) + step_row(s, columns), "steps");
  std::set<std::string> once;
  int per_name = 0;
  for (std::size_t i = 0; i < table.columns().size(); ++i) {
    const std::string& column = table.columns()[i];
    const auto [field, name] = field_of_column(column);
    ASSERT_NE(field, nullptr) << column;
    EXPECT_TRUE(field->in(kSteps)) << column;
    EXPECT_EQ(table.words(column)[0], text_of(field->of(s, name))) << column;
    if (field->per == FieldPer::kStep) {
      once.insert(column);
    } else {
      EXPECT_EQ(std::string(field->name) + '_' + name, column);
      ++per_name;
    }
  }
  EXPECT_EQ(once, names_in(kSteps));
  EXPECT_EQ(per_name, 7 + 2 * 2) << "seven terms, two weights of each of two costs";
  EXPECT_EQ(field_of_column("of another program").first, nullptr);
}

TEST(StepFields, TheColumnsOfTimingCsvAreItsFields) {
  const StepTable table = StepTable::parse(timing_header() + timing_row(full_step()), "timing");
  EXPECT_EQ(std::set(table.columns().begin(), table.columns().end()), names_in(kTiming));
}

TEST(StepFields, TheEntriesOfTheLogAreItsFieldsAndAreReadBack) {
  const StepRecord s = full_step();
  const ros::DiagnosticArray message = step_values(s, 0);
  std::set<std::string> expected = {"cost", "violation"}, told;
  for (const StepField& field : step_fields()) {
    if (field.log_place > 0) expected.emplace(field.name);
  }
  for (const ros::KeyValue& entry : message.status[0].values) {
    const bool per_name = entry.key.find('.') != std::string::npos;
    if (!per_name) {
      EXPECT_TRUE(told.insert(entry.key).second) << entry.key;
    }
  }
  EXPECT_EQ(told, expected);
  StepRecord read;
  read_step_values(message, "message", read);
  for (const StepField& field : step_fields()) {
    for (const TermWeight& weight : s.weights) {
      EXPECT_EQ(text_of(field.of(read, weight.name)), text_of(field.of(s, weight.name)))
          << field.name;
    }
  }
}

TEST(StepFields, TheColumnsOfThePageAreItsFields) {
  const nlohmann::json part =
      nlohmann::json::parse(report_steps({std::make_shared<StepRecord>(full_step())}, 0.1));
  std::set<std::string> names;
  for (const char* kind : {"columns", "words"}) {
    for (const auto& [name, values] : part[kind].items()) names.insert(name);
  }
  EXPECT_EQ(names, names_in(kPage));
}

TEST(StepFields, WhatIsNoSuchValueIsRefusedByName) {
  const auto message = [](const std::string& column, const std::string& text) {
    const auto [field, name] = field_of_column(column);
    StepRecord s;
    try {
      enter_field(*field, name, text, "steps.csv:7", s);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message("area", "much"), "steps.csv:7: area is 'much'; expected a number");
  EXPECT_EQ(message("weight_asked_obstacles", ""),
            "steps.csv:7: weight_asked.obstacles is ''; expected a number");
  EXPECT_EQ(message("localization", "good"),
            "steps.csv:7: localization is 'good'; expected one of ok, degraded, lost");
  EXPECT_EQ(message("localization", ""), "") << "a record that lacks it";
  EXPECT_EQ(message("target_change", "better"), "");
}

}  // namespace
}  // namespace prospect::step_fields_test

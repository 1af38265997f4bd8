// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/views/report/report.h"

namespace prospect::report_steps_test {
namespace {

TermValue term(const std::string& name, double weighted, bool constraint = false) {
  TermValue value;
  value.name = name;
  value.weighted = weighted;
  value.constraint = constraint;
  return value;
}

TEST(Report, EachCostTermOfAnyStepIsAColumn) {
  auto first = std::make_shared<StepRecord>(), second = std::make_shared<StepRecord>();
  first->explanation.terms = {term("path", 2.0), term("clearance", 7.0, true)};
  second->explanation.terms = {term("gain", -1.0), term("path", 0.5)};
  const auto part = nlohmann::json::parse(report_steps({first, second}, 0.1));
  const nlohmann::json& terms = part.at("terms");
  ASSERT_EQ(terms.size(), 2u);
  EXPECT_EQ(terms[0].at("name"), "path");
  EXPECT_EQ(terms[0].at("weighted"), "AAAAQAAAAD8=");  // floats: 2, 0.5
  EXPECT_EQ(terms[1].at("name"), "gain");
  EXPECT_EQ(terms[1].at("weighted"), "AADAfwAAgL8=");  // NaN, -1
}

TEST(Report, AStepHasWhatMovesByItself) {
  auto first = std::make_shared<StepRecord>(), second = std::make_shared<StepRecord>();
  Mover mover, broken;
  mover.position = {2.0, 0.5};
  mover.velocity = {-1.0, 0.0};
  mover.radius = 0.5;
  broken.position.x() = std::numeric_limits<double>::quiet_NaN();
  second->movers = {broken, mover};
  const auto part = nlohmann::json::parse(report_steps({first, second}, 0.1));
  EXPECT_EQ(part.at("movers").at("counts"), "AAE=");                          // 0, 1
  EXPECT_EQ(part.at("movers").at("values"), "AAAAQAAAAD8AAIC/AAAAAAAAAD8=");  // 2, 0.5, -1, 0, 0.5
}

}  // namespace
}  // namespace prospect::report_steps_test

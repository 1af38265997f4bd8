// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace prospect::report_steps_test

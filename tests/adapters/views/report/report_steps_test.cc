#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "adapters/views/report/report.h"

namespace prospect::report_steps_test {
namespace {

TEST(Report, EachCostTermOfAnyStepIsAColumn) {
  auto first = std::make_shared<StepRecord>(), second = std::make_shared<StepRecord>();
  first->explanation.terms = {{.name = "path", .weighted = 2.0},
                              {.name = "clearance", .weighted = 7.0, .constraint = true}};
  second->explanation.terms = {{.name = "gain", .weighted = -1.0},
                               {.name = "path", .weighted = 0.5}};
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

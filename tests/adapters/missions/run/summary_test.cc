// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace prospect::summary_test {
namespace {

StepRecord step(double time, double coverage, double path, double error, double plan_ms) {
  StepRecord s;
  s.time = time;
  s.coverage = coverage;
  s.path_length = path;
  s.localization_error = error;
  s.wall.plan = plan_ms;
  s.plan_kind = PlanKind::kOptimised;
  return s;
}

TEST(Summary, ByHand) {
  std::vector<StepRecord> steps = {
      step(0.0, 0.10, 0.0, 0.0, 30.0),
      step(10.0, 0.88, 4.0, 0.3, 10.0),
      step(20.0, 0.92, 9.0, 0.4, 50.0),  // 0.90 halfway from the step before
      step(25.0, 0.96, 10.0, 0.0, 20.0),
  };
  steps[1].plan_kind = PlanKind::kStoppingTail;
  steps[1].guard_stops = 2;
  steps[3].guard_stops = 1;
  steps[3].area = 96.5;
  steps[3].collisions = 1;
  steps[3].localization_error = 0.5;
  const Summary s = summarize(steps);
  EXPECT_NEAR(s.time_to_90_s, 15.0, 1e-9);
  EXPECT_NEAR(s.path_to_90_m, 6.5, 1e-9);
  EXPECT_NEAR(s.time_to_95_s, 23.75, 1e-9);  // three quarters of the last step
  EXPECT_NEAR(s.path_to_95_m, 9.75, 1e-9);
  EXPECT_TRUE(std::isnan(s.time_to_99_s));
  EXPECT_TRUE(std::isnan(s.path_to_99_m));
  EXPECT_EQ(s.coverage, 0.96);
  EXPECT_EQ(s.area_m2, 96.5);
  EXPECT_EQ(s.collisions, 1);
  EXPECT_EQ(s.duration_s, 25.0);
  EXPECT_EQ(s.path_length_m, 10.0);
  EXPECT_NEAR(s.localization_rmse_m, std::sqrt((0.09 + 0.16 + 0.25) / 4.0), 1e-12);
  EXPECT_EQ(s.localization_final_m, 0.5);
  EXPECT_NEAR(s.drift_percent, 5.0, 1e-12);
  EXPECT_EQ(s.plan_ms_p50, 20.0);  // second of 10 20 30 50
  EXPECT_EQ(s.plan_ms_p95, 50.0);
  EXPECT_EQ(s.plan_ms_max, 50.0);
  EXPECT_EQ(s.fallbacks, 1);
  EXPECT_EQ(s.guard_stops, 3);
  EXPECT_EQ(s.steps, 4);
}

TEST(Summary, ReachedExactlyOrFromTheStart) {
  const Summary s = summarize({step(3.0, 0.95, 1.0, 0.0, 1.0), step(4.0, 0.99, 2.0, 0.0, 1.0)});
  EXPECT_EQ(s.time_to_90_s, 3.0);
  EXPECT_EQ(s.time_to_95_s, 3.0);
  EXPECT_EQ(s.time_to_99_s, 4.0);
}

TEST(Summary, OfNothing) {
  const Summary s = summarize(std::vector<StepRecord>{});
  EXPECT_EQ(s.steps, 0);
  EXPECT_EQ(s.coverage, 0.0);
  EXPECT_TRUE(std::isnan(s.time_to_90_s));
  EXPECT_TRUE(std::isnan(s.plan_ms_p95));
  const Summary still = summarize({step(1.0, 0.5, 0.0, 0.2, 1.0)});
  EXPECT_TRUE(std::isnan(still.drift_percent)) << "no path, no share of it";
  EXPECT_TRUE(std::isnan(summarize({step(1.0, 0.5, 1e-17, 0.2, 1.0)}).drift_percent))
      << "rounding is no path";
  EXPECT_TRUE(std::isnan(s.localization_rmse_m));
  EXPECT_TRUE(std::isnan(s.localization_final_m));
}

TEST(Summary, WithoutAReachableAreaNoShareOfItIsReached) {
  const Summary s = summarize({step(0.0, NAN, 0.0, 0.0, 1.0), step(1.0, NAN, 0.3, 0.0, 1.0)});
  EXPECT_TRUE(std::isnan(s.coverage));
  EXPECT_TRUE(std::isnan(s.time_to_90_s));
  EXPECT_TRUE(std::isnan(s.path_to_99_m));
  EXPECT_TRUE(nlohmann::json::parse(summary_json(s))["coverage"].is_null());
}

TEST(SummaryJson, HasTheStableNamesAndNullForNotFinite) {
  Summary s = summarize({step(10.0, 0.93, 4.0, 0.1, 12.0)});
  s.world = "office \"A\"";
  s.solver = "nlopt:LD_SLSQP";
  s.seed = 18446744073709551615ULL;
  s.end = MissionEnd::kExplored;
  s.task = "explore";
  s.done = true;
  s.detail = "Done: no frontier is left.";
  s.drift_percent = INFINITY;
  const auto json = nlohmann::json::parse(summary_json(s));
  for (const char* name : {"world",
                           "solver",
                           "seed",
                           "reason",
                           "coverage",
                           "area_m2",
                           "reachable_area_m2",
                           "too_long_for_m2",
                           "collisions",
                           "losses",
                           "duration_s",
                           "wall_s",
                           "path_length_m",
                           "time_to_90_s",
                           "time_to_95_s",
                           "time_to_99_s",
                           "localization_rmse_m",
                           "localization_final_m",
                           "drift_percent",
                           "plan_ms",
                           "deadline_misses",
                           "fallbacks",
                           "floor_share",
                           "read_without"}) {
    EXPECT_TRUE(json.contains(name)) << name;
  }
  EXPECT_EQ(json["world"], "office \"A\"");
  EXPECT_EQ(json["seed"], 18446744073709551615ULL);
  EXPECT_EQ(json["time_to_90_s"], 10.0);
  EXPECT_TRUE(json["time_to_95_s"].is_null());
  EXPECT_TRUE(json["drift_percent"].is_null());
  EXPECT_EQ(json["plan_ms"]["p95"], 12.0);
  EXPECT_EQ(json["task"], "explore");
  EXPECT_EQ(json["done"], true);
  EXPECT_EQ(json["reason"], "explored");
  EXPECT_EQ(json["outcome"], "done");
  EXPECT_TRUE(json["turned_back_s"].is_null());
  EXPECT_TRUE(json["heading_missed_deg"].is_null());
  EXPECT_EQ(json["detail"], "Done: no frontier is left.");
}

// What exit codes, colours and studies judge by.
TEST(Summary, OutcomeIsThatOfTheEndAndOfHowItWasDone) {
  struct Case {
    MissionEnd end;
    bool done;
    int collisions;
    Outcome outcome;
  };
  for (const Case& c : {Case{MissionEnd::kExplored, true, 0, Outcome::kDone},
                        Case{MissionEnd::kExplored, true, 1, Outcome::kFailed},
                        Case{MissionEnd::kExplored, false, 0, Outcome::kNotDone},  // not back
                        Case{MissionEnd::kTimeLimit, false, 0, Outcome::kNotDone},
                        Case{MissionEnd::kTimeLimit, true, 0, Outcome::kNotDone},
                        Case{MissionEnd::kUnexplained, true, 0, Outcome::kFailed},
                        Case{MissionEnd::kCancelled, false, 2, Outcome::kCancelled}}) {
    Summary s;
    s.end = c.end;
    s.done = c.done;
    s.collisions = c.collisions;
    EXPECT_EQ(outcome(s), c.outcome) << to_string(c.end) << c.done << c.collisions;
    const auto again = summary_from_json(summary_json(s));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->end, c.end);
    EXPECT_EQ(outcome(*again), c.outcome);
  }
  EXPECT_EQ(outcome(Summary()), Outcome::kFailed) << "nothing is known of it";
  EXPECT_FALSE(summary_from_json(R"({"reason": "all went well"})")) << "no such end";
}

TEST(SummaryJson, TakesTextThatIsNoUtf8) {
  Summary s;
  s.world = "caf\xe9.bt";
  EXPECT_EQ(nlohmann::json::parse(summary_json(s))["world"], "caf\xEF\xBF\xBD.bt");
}

TEST(Summary, IsReadBackFromItsText) {
  Summary summary = summarize(std::vector<StepRecord>());
  summary.world = "eight \"rooms\"";
  summary.seed = 18446744073709551615ULL;
  summary.done = true;
  summary.collisions = 3;
  summary.coverage = 1.0 / 3.0;
  summary.plan_ms_p95 = 12.5;
  const std::optional<Summary> read = summary_from_json(summary_json(summary));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(summary_json(*read), summary_json(summary)) << "each entry, those that are null, too";
  EXPECT_EQ(read->coverage, 1.0 / 3.0);
  EXPECT_TRUE(read->measured);
  summary.measured = false;
  EXPECT_FALSE(summary_from_json(summary_json(summary))->measured);
  for (const char* none : {"", "{", "[]", R"({"steps": "many"})", R"({"plan_ms": 3})"}) {
    EXPECT_FALSE(summary_from_json(none).has_value()) << none;
  }
  EXPECT_EQ(summary_from_json(R"({"steps": 4})")->steps, 4) << "of an older program: what is there";
}

}  // namespace
}  // namespace prospect::summary_test

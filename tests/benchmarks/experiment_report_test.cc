#include "benchmarks/experiments/experiment_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "adapters/config/configuration.h"
#include "adapters/files/input_error.h"
#include "benchmarks/experiments/conditions.h"
#include "benchmarks/replanners.h"

namespace prospect::experiment_report_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ExperimentRow row(const std::string& world, const std::string& condition, std::uint64_t seed,
                  double losses) {
  ExperimentRow r;
  r.world = world;
  r.condition = condition;
  r.seed = seed;
  r.sensors = "model";
  r.reason = "explored";
  r.losses = losses;
  return r;
}

TEST(ExperimentReport, PairsByWorldAndSeedAndCountsWhatIsMissing) {
  std::vector<ExperimentRow> rows;
  // Always one loss more without, whatever the pair has; 2 to 7 with.
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    rows.push_back(row("office", "without", seed, 2.0 + static_cast<double>(seed)));
    rows.push_back(row("office", "with", seed, 1.0 + static_cast<double>(seed)));
  }
  rows.push_back(row("office", "with", 7, 100.0));  // has no partner
  ExperimentRow failed = row("plan:3", "without", 1, NAN);
  failed.reason = "failed: signal 11";
  rows.push_back(failed);
  rows.push_back(row("plan:3", "with", 1, 50.0));
  const std::string report = experiment_report(rows);
  EXPECT_THAT(report, HasSubstr("| model | `without` | 7 | explored: 6, failed: signal 11: 1 |"));
  EXPECT_THAT(report, HasSubstr("sensors model, all worlds, 7 pairs"));
  EXPECT_THAT(report, HasSubstr("floor plans, 1 pairs"));
  // 33 / 27 losses; six differences of one sign: p = 2 / 64.
  EXPECT_THAT(report, HasSubstr("| losses of localization | 4.5 | 5.5 | 6 (only one side: 1 / 0) | "
                                "1.0 [1.0, 1.0] | 1.22 ["));
  EXPECT_THAT(report, HasSubstr("] | 0.031 |"));
  EXPECT_THAT(report, HasSubstr("| office | 6 | 1.22 ["));
  EXPECT_THAT(report, HasSubstr("| plan:3 | 1 | - |"));
  EXPECT_THAT(report, Not(HasSubstr("camera")));
}

TEST(ExperimentReport, ShowsSeveralConditionsSideBySide) {
  std::vector<ExperimentRow> rows;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    rows.push_back(row("office", "with", seed, 2.0));
    rows.push_back(row("office", "without", seed, 3.0));
  }
  EXPECT_THAT(experiment_report(rows), Not(HasSubstr("by condition")));
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    rows.push_back(row("office", "nearest", seed, 1.0));
  }
  const std::string report = experiment_report(rows);
  EXPECT_THAT(report, HasSubstr("Ratio of means [95 %] by condition:"));
  EXPECT_THAT(report, HasSubstr("| `without` / `with`, model | 3 | 1.50 [1.50, 1.50] | - |"));
  EXPECT_THAT(report, HasSubstr("| `nearest` / `with`, model | 2 | 0.50 [0.50, 0.50] | - |"));
}

TEST(ExperimentReport, SensorsAreNotMixed) {
  ExperimentRow other = row("office", "without", 1, 3.0);
  other.sensors = "camera";
  EXPECT_THAT(experiment_report({row("office", "with", 1, 2.0), other}), Not(HasSubstr("against")));
}

TEST(Conditions, AreConfigurationsThatDifferFromTheirReference) {
  for (const Condition& c : conditions()) {
    const Configuration configuration = configuration_from_text(c.overlay, c.name);
    if (c.reference.empty()) continue;
    const Condition& reference = condition(c.reference);
    EXPECT_TRUE(reference.reference.empty()) << c.name;
    const Configuration base = configuration_from_text(reference.overlay, reference.name);
    int different = 0;
    for (std::size_t i = 0; i < configuration.entries.size(); ++i) {
      different += configuration.entries[i].value != base.entries[i].value;
    }
    EXPECT_GE(different + (c.planner != reference.planner), 1) << c.name;
    EXPECT_NO_THROW(replanner_maker(c.planner)) << c.name;
    EXPECT_LE(different, 2) << c.name;
  }
  EXPECT_THROW(condition("witth"), InputError);
}

}  // namespace
}  // namespace prospect::experiment_report_test

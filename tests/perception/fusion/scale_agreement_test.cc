// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/scale_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace prospect::scale_agreement_test {
namespace {

using Verdict = ScaleAgreement::Verdict;

std::vector<double> noisy_log_ratios(double ratio, double sigma, int n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<double> samples;
  for (int i = 0; i < n; ++i) samples.push_back(std::log(ratio) + sigma * normal(rng));
  return samples;
}

TEST(ScaleAgreement, TellsARatioFromNoise) {
  int wrong = 0, missed = 0;
  double squared = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const auto same = scale_agreement(noisy_log_ratios(1.0, 0.06, 16, 2 * run), 0.05, 0.01);
    const auto other = scale_agreement(noisy_log_ratios(1.2, 0.06, 16, 2 * run + 1), 0.05, 0.01);
    wrong += same.verdict != Verdict::kAgree;
    missed += other.verdict != Verdict::kDisagree;
    squared += std::pow(std::log(same.ratio) / std::sqrt(same.sigma * same.sigma - 1e-4), 2);
    EXPECT_EQ(same.samples, 16);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(missed, kRuns / 100);
  // Honest, but for the few samples that the spread is estimated from.
  EXPECT_GT(squared / kRuns, 0.7);
  EXPECT_LT(squared / kRuns, 2.0);
}

TEST(ScaleAgreement, SaysNothingOfFewAndIsNotLedByWhatIsWrong) {
  EXPECT_EQ(scale_agreement({}, 0.0, 0.0).verdict, Verdict::kUnknown);
  EXPECT_EQ(scale_agreement(noisy_log_ratios(2.0, 0.01, 5, 1), 0.0, 0.0).verdict,
            Verdict::kUnknown);
  // Five of twelve are nonsense.
  std::vector<double> samples = noisy_log_ratios(1.0, 0.02, 7, 2);
  for (const double bad : {1.5, 1.2, 0.9, -1.0, 1.4}) samples.push_back(bad);
  samples.push_back(std::numeric_limits<double>::quiet_NaN());
  const ScaleAgreement agreement = scale_agreement(samples, 0.0, 0.0);
  EXPECT_EQ(agreement.samples, 12);
  EXPECT_NE(agreement.verdict, Verdict::kDisagree);
  // What both may be off by together is not held against them.
  EXPECT_EQ(scale_agreement(noisy_log_ratios(1.12, 0.01, 16, 3), 0.0, 0.05).verdict,
            Verdict::kAgree);
  EXPECT_EQ(scale_agreement(noisy_log_ratios(1.12, 0.01, 16, 3), 0.0, 0.01).verdict,
            Verdict::kDisagree);
}

TEST(ScaleAgreement, SaysItInWords) {
  ScaleAgreement agreement{Verdict::kDisagree, 1.5, 0.02, 12};
  EXPECT_EQ(to_string(agreement, "this is", "that"),
            "this is 1.500 times as long as that, +- 2.0 % (12 samples)");
}

}  // namespace
}  // namespace prospect::scale_agreement_test

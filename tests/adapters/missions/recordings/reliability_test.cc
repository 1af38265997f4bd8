// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/reliability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace prospect::reliability_test {
namespace {

TEST(Reliability, OfPredictionsThatAreTrueEveryBinIsOnTheDiagonal) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> predicted;
  std::vector<char> outcome;
  double brier = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double p = uniform(generator);
    predicted.push_back(p);
    outcome.push_back(uniform(generator) < p);
    brier += p * (1.0 - p) / 40000.0;
  }
  const Reliability r = reliability(predicted, outcome);
  EXPECT_EQ(r.count, 40000);
  int count = 0;
  for (std::size_t k = 0; k < r.bins.size(); ++k) {
    EXPECT_NEAR(r.bins[k].predicted, 0.05 + 0.1 * static_cast<double>(k), 0.005);
    EXPECT_NEAR(r.bins[k].observed, r.bins[k].predicted, 0.03);
    count += r.bins[k].count;
  }
  EXPECT_EQ(count, 40000);
  EXPECT_LT(r.error, 0.02);
  EXPECT_NEAR(r.brier, brier, 0.005);
}

TEST(Reliability, PredictionsThatAreTooSureAreSeen) {
  // All are given 0.9, seven in ten come true.
  std::vector<double> predicted(1000, 0.9);
  std::vector<char> outcome;
  for (int i = 0; i < 1000; ++i) outcome.push_back(i % 10 < 7);
  const Reliability r = reliability(predicted, outcome);
  EXPECT_NEAR(r.error, 0.2, 1e-12);
  EXPECT_NEAR(r.brier, 0.7 * 0.01 + 0.3 * 0.81, 1e-12);
  EXPECT_EQ(r.bins[9].count, 1000);
  EXPECT_NEAR(r.bins[9].observed, 0.7, 1e-12);
}

TEST(Reliability, TheEndsBelongToTheOuterBins) {
  const Reliability r = reliability({0.0, 1.0}, {0, 1});
  EXPECT_EQ(r.bins[0].count, 1);
  EXPECT_EQ(r.bins[9].count, 1);
  EXPECT_EQ(r.brier, 0.0);
  EXPECT_EQ(r.error, 0.0);
  EXPECT_EQ(reliability({}, {}).count, 0);
}

TEST(Reliability, RefusesWhatIsNoPrediction) {
  EXPECT_THROW(reliability({0.5}, {}), std::invalid_argument);
  EXPECT_THROW(reliability({1.1}, {1}), std::invalid_argument);
  EXPECT_THROW(reliability({std::nan("")}, {1}), std::invalid_argument);
}

TEST(CountAgreement, BiasErrorAndCorrelation) {
  const CountAgreement a = count_agreement({12, 22, 28, 42}, {10, 20, 30, 40});
  EXPECT_EQ(a.count, 4);
  EXPECT_NEAR(a.bias, 1.0, 1e-12);
  EXPECT_NEAR(a.mean_absolute_error, 2.0, 1e-12);
  EXPECT_NEAR(a.correlation, 480.0 / std::sqrt(472.0 * 500.0), 1e-12);
  EXPECT_NEAR(count_agreement({1, 2, 3}, {3, 2, 1}).correlation, -1.0, 1e-12);
}

TEST(CountAgreement, NothingVariesNothingCorrelates) {
  EXPECT_TRUE(std::isnan(count_agreement({5, 5, 5}, {1, 2, 3}).correlation));
  EXPECT_TRUE(std::isnan(count_agreement({5}, {1}).correlation));
  EXPECT_TRUE(std::isnan(count_agreement({}, {}).correlation));
  EXPECT_THROW(count_agreement({5}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::reliability_test

// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/track_survival.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace prospect::track_survival_test {
namespace {

/// A Beta(b, a) number, from two gamma ones.
double beta(double b, double a, std::mt19937& generator) {
  std::gamma_distribution<double> x(b, 1.0), y(a, 1.0);
  const double first = x(generator), second = y(generator);
  return first / (first + second);
}

/// Views of `n` landmarks, each with its own loss rate, until each is lost or `longest` views old.
TrackSurvival watched(int n, double a, double b, int longest) {
  TrackSurvival survival;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < n; ++i) {
    const double q = beta(b, a, generator);
    for (int age = 0; age < longest; ++age) {
      const bool found = uniform(generator) >= q;
      survival.add(age, found);
      if (!found) break;
    }
  }
  return survival;
}

TEST(TrackSurvival, FindsWhatTracksWereMadeWith) {
  const double a = 5.1, b = 1.5;
  const TrackSurvival::Fit fit = watched(4000, a, b, 50).fit();
  EXPECT_NEAR(fit.loss, b / (a + b), 0.01);
  EXPECT_NEAR(std::log(fit.strength), std::log(a + b), 0.4);  // the strengths tried are 0.38 apart

  // What it predicts comes true, for young and old landmarks, near and far ahead.
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const int age : {0, 3, 10}) {
    for (const int ahead : {1, 5, 10}) {
      int at_age = 0, later = 0;
      while (at_age < 4000) {
        const double q = beta(b, a, generator);
        int life = 0;
        while (life < age + ahead && uniform(generator) >= q) ++life;
        at_age += life >= age;
        later += life >= age + ahead;
      }
      EXPECT_NEAR(TrackSurvival::probability(fit, age, false, ahead),
                  static_cast<double>(later) / at_age, 0.03)
          << age << " " << ahead;
    }
  }
}

TEST(TrackSurvival, WhereAllAreAlikeAgeDoesNotMatter) {
  TrackSurvival survival;
  std::mt19937 generator(5);
  for (int i = 0; i < 4000; ++i) {
    for (int age = 0; age < 60; ++age) {
      const bool found = generator() % 100 >= 3;
      survival.add(age, found);
      if (!found) break;
    }
  }
  const TrackSurvival::Fit fit = survival.fit();
  EXPECT_NEAR(TrackSurvival::probability(fit, 0, false, 1), 0.97, 0.005);
  EXPECT_NEAR(TrackSurvival::probability(fit, 40, false, 1), 0.97, 0.01);
  EXPECT_NEAR(TrackSurvival::probability(fit, 0, false, 20), std::pow(0.97, 20), 0.04);
}

TEST(TrackSurvival, BeforeAnyViewItIsThePrior) {
  const TrackSurvival::Fit fit = TrackSurvival().fit();
  EXPECT_NEAR(TrackSurvival::probability(fit, 0, false, 1), 0.93, 1e-12);
  // Five views of one place: its loss is one number, not a new one at each view.
  EXPECT_NEAR(TrackSurvival::probability(fit, 0, false, 5),
              3.72 / 4 * 4.72 / 5 * 5.72 / 6 * 6.72 / 7 * 7.72 / 8, 1e-12);
  EXPECT_NEAR(TrackSurvival::probability(fit, 0, true, 1), 0.5, 1e-12);
}

TEST(TrackSurvival, MissedOnesComeBackAsOftenAsTheyDid) {
  TrackSurvival survival;
  for (int i = 0; i < 1000; ++i) survival.add_missed(i % 4 == 0);
  EXPECT_NEAR(TrackSurvival::probability(survival.fit(), 5, true, 1), 0.25, 0.01);
}

TEST(TrackSurvival, ForgetsWhatIsLongPast) {
  TrackSurvival::Options options;
  options.memory = 20.0;
  TrackSurvival survival(options);
  for (int frame = 0; frame < 300; ++frame) {
    for (int i = 0; i < 50; ++i) survival.add(0, frame >= 100 || i >= 25);  // half, then none lost
    survival.forget();
  }
  EXPECT_GT(TrackSurvival::probability(survival.fit(), 0, false, 1), 0.99);
}

TEST(TrackSurvival, RefusesWhatIsNoProbability) {
  TrackSurvival::Options options;
  options.prior_loss = 0.0;
  EXPECT_THROW(TrackSurvival{options}, std::invalid_argument);
  options = {};
  options.memory = 0.0;
  EXPECT_THROW(TrackSurvival{options}, std::invalid_argument);
  options = {};
  options.prior_views = -1.0;
  EXPECT_THROW(TrackSurvival{options}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::track_survival_test

#include "engine/leftovers_clock.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace prospect {
namespace {

constexpr LeftoversClock::Options kOptions{.share = 0.7, .least = 60.0, .growth = 0.1};

/// Two places 2 m apart, 10 s each.
Eigen::Vector2d on_the_move(double t) { return {static_cast<int>(t / 10.0) % 2 * 2.0, 0.0}; }

/// When it is up, in steps of 0.5 s, if it begins at `begin`; explored(t) [m^2].
template <typename Explored, typename Place>
double end_of(double begin, Explored explored, Place place) {
  LeftoversClock clock(kOptions);
  for (double t = 0.0; t < 1000.0; t += 0.5) {
    clock.update(t, place(t), explored(t));
    if (t >= begin) clock.begin(t, explored(t));
    if (clock.up(t)) return t;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(LeftoversClock, IsUpAfterAShareOfTheTimeBeforeOrTheLeastTime) {
  const auto explored = [](double) { return 100.0; };
  EXPECT_EQ(end_of(10.0, explored, on_the_move), 70.5);
  EXPECT_EQ(end_of(200.0, explored, on_the_move), 340.5);
}

TEST(LeftoversClock, IsNeverUpBeforeItBegins) {
  LeftoversClock clock(kOptions);
  EXPECT_FALSE(clock.up(1e9));
  EXPECT_FALSE(clock.update(0.0, {0.0, 0.0}, 1.0));
  EXPECT_FALSE(clock.up(1e9));
  EXPECT_FALSE(clock.update(1.0, {0.0, 0.0}, 100.0)) << "growth counts from the beginning on";
}

TEST(LeftoversClock, BeginsAnewWithATenthMore) {
  const auto grows_to = [](double area) {
    return [area](double t) { return t < 50.0 ? 100.0 : area; };
  };
  EXPECT_EQ(end_of(10.0, grows_to(109.0), on_the_move), 70.5);
  EXPECT_EQ(end_of(10.0, grows_to(110.5), on_the_move), 110.5);
  // A tenth of what there was then.
  EXPECT_EQ(
      end_of(
          10.0, [](double t) { return t < 50.0   ? 100.0
                                      : t < 60.0 ? 111.0
                                                 : 120.0; }, on_the_move),
      110.5);
  // It never ends earlier than it would have.
  EXPECT_EQ(end_of(
                200.0, [](double t) { return t < 210.0 ? 100.0 : 111.0; }, on_the_move),
            340.5);
}

TEST(LeftoversClock, DoesNotCountTheTimeInWhichTheRobotIsHeld) {
  const auto explored = [](double) { return 100.0; };
  const auto held_until = [](double end) {
    return [end](double t) -> Eigen::Vector2d {
      return t < 10.0 || t >= end ? on_the_move(t) : Eigen::Vector2d(5.0, 0.9 * (t / end));
    };
  };
  // The first 20 s in a place count.
  EXPECT_EQ(end_of(10.0, explored, held_until(29.5)), 70.5);
  EXPECT_EQ(end_of(10.0, explored, held_until(50.0)), 70.5 + 20.0);
  EXPECT_EQ(end_of(10.0, explored, held_until(1000.0)), 70.5 + 60.0) << "no longer than that";
}

TEST(LeftoversClock, OptionsOutOfRangeAreNamed) {
  for (const LeftoversClock::Options& bad :
       {LeftoversClock::Options{.share = -0.1}, LeftoversClock::Options{.least = 2e6},
        LeftoversClock::Options{.growth = std::numeric_limits<double>::quiet_NaN()}}) {
    EXPECT_THROW(LeftoversClock{bad}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect

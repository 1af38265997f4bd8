#include "engine/frontier_memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace prospect::frontier_memory_test {
namespace {

const GridFrame kFrame{0.1, 0, 0, 100, 100};

Frontier frontier(int i, int j, int n) {
  Frontier f;
  for (int k = 0; k < n; ++k) f.cells.push_back({i + k, j});
  f.length = 0.1 * n;
  f.active = true;
  return f;
}

Pose at(double x, double y, double yaw) { return {{x, y, 0.0}, yaw}; }

class Memory : public ::testing::Test {
 protected:
  Grid<std::uint8_t> map_ = Grid<std::uint8_t>(kFrame, 1);  // nonzero: seen through
  using enum FrontierMemory::Verdict;
  FrontierMemory memory_{FrontierMemoryOptions{}};

  void look(const std::vector<Frontier>& f, const Pose& pose, int times) {
    for (const Frontier& one : f) {
      for (const Cell c : one.cells) map_[c] = 0;
    }
    for (int k = 0; k < times; ++k) memory_.look(map_, f, pose, clock_ += 0.5);
  }
  // The position of a robot that has driven on since the last call.
  Eigen::Vector2d walked() { return {way_ += 0.3, 0.0}; }
  double clock_ = 0.0;
  double way_ = 0.0;
};

// Lesson 5: a look that fails four times deactivates its frontier, and only what was in view.
TEST_F(Memory, FourFailedLooksSuppressWhatWasInView) {
  const std::vector<Frontier> f{frontier(50, 50, 8), frontier(50, 5, 8), frontier(95, 50, 4)};
  look(f, at(3.0, 5.0, 0.0), 3);
  EXPECT_EQ(memory_.suppressed_count(), 0);
  look(f, at(3.0, 5.0, 0.0), 1);
  // The first cell hides the others of its row; to the side and out of range are not in view.
  EXPECT_TRUE(memory_.suppressed({50, 50}));
  EXPECT_FALSE(memory_.suppressed({52, 50}));
  EXPECT_FALSE(memory_.suppressed({50, 5}));
  EXPECT_FALSE(memory_.suppressed({95, 50}));
  Grid<std::uint8_t> mask;
  memory_.suppression(kFrame, mask);
  int sum = 0;
  for (const auto m : mask.data) sum += m;
  EXPECT_EQ(sum, memory_.suppressed_count());
  EXPECT_EQ(mask[(Cell{50, 50})], 1);
}

TEST_F(Memory, AnObstacleOrTheUnknownHidesAFrontier) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{40, 50}] = 0;
  look(f, at(3.05, 5.05, 0.0), 6);
  EXPECT_EQ(memory_.suppressed_count(), 0);
  map_[{40, 50}] = 1;
  look(f, at(3.05, 5.05, M_PI), 6);  // looking away
  EXPECT_EQ(memory_.suppressed_count(), 0);
  look(f, at(3.05, 5.05, 2.0 * M_PI + 0.3), 4);
  EXPECT_EQ(memory_.suppressed_count(), 1);
}

TEST_F(Memory, FastReplanningDoesNotCountALookTwice) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{50, 50}] = 0;
  for (int k = 0; k < 12; ++k) memory_.look(map_, f, at(3.0, 5.05, 0.0), 0.1 * k);
  EXPECT_EQ(memory_.suppressed_count(), 0);  // looks at 0, 0.4, 0.8; the fourth is at 1.2
  EXPECT_EQ(
      [&] {
        FrontierMemory m{FrontierMemoryOptions{}};
        int steps = 0;
        while (m.suppressed_count() == 0) m.look(map_, f, at(3.0, 5.05, 0.0), 0.1 * steps++);
        return steps;
      }(),
      13);
}

TEST_F(Memory, AChangeWithinTwoCellsForgives) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  look(f, at(3.0, 5.05, 0.0), 4);
  ASSERT_TRUE(memory_.suppressed({50, 50}));
  memory_.map_changed({}, {{53, 50}, {50, 47}, {10, 10}});
  EXPECT_TRUE(memory_.suppressed({50, 50}));
  memory_.map_changed({}, {{52, 52}});
  EXPECT_FALSE(memory_.suppressed({50, 50}));
  EXPECT_EQ(memory_.suppressed_count(), 0);
  // The counter starts anew.
  look(f, at(3.0, 5.05, 0.0), 3);
  EXPECT_FALSE(memory_.suppressed({50, 50}));
}

// Noise flips a cell for ever: it may forgive twice only. What newly became known always does.
TEST_F(Memory, FlickeringCellsForgiveTwiceOnly) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  int forgiven = 0;
  for (int k = 0; k < 6; ++k) {
    look(f, at(3.0, 5.05, 0.0), 4);
    ASSERT_TRUE(memory_.suppressed({50, 50}));
    memory_.map_changed({}, {{51, 50}});
    forgiven += !memory_.suppressed({50, 50});
  }
  EXPECT_EQ(forgiven, 2);
  memory_.map_changed({{51, 50}}, {{51, 50}});
  EXPECT_FALSE(memory_.suppressed({50, 50}));
  EXPECT_EQ(memory_.suppressed_count(), 0);
}

TEST_F(Memory, HysteresisFollowsATargetThatRecedes) {
  std::vector<Frontier> f{frontier(10, 10, 5), frontier(50, 50, 5)};
  EXPECT_EQ(memory_.current_target(f, kFrame), -1);
  memory_.judge(f, kFrame, {{1, {52, 50}}}, walked(), 3.0, 10.0, 0.0);
  EXPECT_EQ(memory_.current_target(f, kFrame), 1);
  f = {frontier(52, 58, 5), frontier(10, 10, 5)};  // receded by 0.8 m, and renumbered
  EXPECT_EQ(memory_.current_target(f, kFrame), 0);
  f = {frontier(52, 70, 5), frontier(10, 10, 5)};  // resolved: what is left is another one
  EXPECT_EQ(memory_.current_target(f, kFrame), -1);
}

TEST_F(Memory, AHopelessTargetIsSuppressed) {
  const std::vector<Frontier> f{frontier(50, 50, 30)};
  std::optional<double> dropped;
  for (double t = 0.0; t < 10.0 && !dropped; t += 0.5) {
    if (memory_.judge(f, kFrame, {{0, {52, 50}}}, walked(), 3.0, 10.0, t) == kAskAgain) dropped = t;
    EXPECT_EQ(memory_.progress().stalled(), t >= 3.0 && !dropped) << t;
  }
  EXPECT_EQ(dropped, 8.0);
  // Within target_radius of the target, not the whole of a long frontier.
  EXPECT_TRUE(memory_.suppressed({50, 50}));
  EXPECT_TRUE(memory_.suppressed({62, 50}));
  EXPECT_FALSE(memory_.suppressed({63, 50}));
  EXPECT_EQ(memory_.suppressed_count(), 13);
  EXPECT_EQ(memory_.given_up(), 1);
  EXPECT_EQ(memory_.judge(f, kFrame, {{0, {70, 50}}}, walked(), 4.0, 10.0, 8.5), kPursue);
  EXPECT_EQ(memory_.progress().stalled_for(), 0.5);
}

TEST_F(Memory, ComingNearerOrSeeingMoreIsProgress) {
  const std::vector<Frontier> f{frontier(50, 50, 10)};
  for (int k = 0; k < 120; ++k) {
    const double value = k < 60 ? 20.0 - 0.1 * k : 14.0;
    const double explored = k < 60 ? 10.0 : 10.0 + 0.05 * (k - 60);
    EXPECT_EQ(memory_.judge(f, kFrame, {{0, {52, 50}}}, walked(), value, explored, 0.5 * k),
              kPursue);
    EXPECT_FALSE(memory_.progress().stalled()) << k;
  }
  EXPECT_EQ(memory_.suppressed_count(), 0);
}

// A farther target after the near one was resolved is no stall as long as the robot drives to it.
TEST_F(Memory, AFartherTargetIsMeasuredAnew) {
  const std::vector<Frontier> f{frontier(50, 50, 10), frontier(90, 90, 10)};
  memory_.judge(f, kFrame, {{0, {52, 50}}}, walked(), 0.5, 10.0, 0.0);
  for (int k = 1; k < 60; ++k) {
    memory_.judge(f, kFrame, {{1, {92, 90}}}, walked(), 30.0 - 0.25 * k, 10.0, 0.5 * k);
    EXPECT_FALSE(memory_.progress().stalled()) << k;
  }
}

TEST_F(Memory, FlickeringBetweenTwoTargetsIsAStall) {
  const std::vector<Frontier> f{frontier(50, 50, 10), frontier(90, 90, 10)};
  bool stalled = false, dropped = false;
  for (int k = 0; k < 20; ++k) {
    const Cell cell = k % 2 == 0 ? Cell{52, 50} : Cell{92, 90};
    dropped = dropped || memory_.judge(f, kFrame, {{k % 2, cell}}, walked(), 3.0 + 0.1 * (k % 2),
                                       10.0, 0.5 * k) == kAskAgain;
    stalled = stalled || memory_.progress().stalled();
  }
  EXPECT_TRUE(stalled);
  EXPECT_TRUE(dropped);
}

// Before "done" everything suppressed is tried again, twice; 5: permanent blacklists cut off rooms.
TEST_F(Memory, DoneOnlyAfterTwoRetries) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  int retries = 0;
  for (int k = 0; k < 5; ++k) {
    look(f, at(3.0, 5.05, 0.0), 4);
    ASSERT_EQ(memory_.suppressed_count(), 1);
    const auto verdict = memory_.judge(f, kFrame, std::nullopt, walked(), 0.0, 10.0, clock_);
    if (verdict == kNothingLeft) break;
    EXPECT_EQ(verdict, kAskAgain);
    EXPECT_EQ(memory_.suppressed_count(), 0);
    ++retries;
  }
  EXPECT_EQ(retries, 2);
  EXPECT_EQ(memory_.retries_used(), 2);
  // Much newly explored: the retries are restored.
  EXPECT_EQ(memory_.judge(f, kFrame, std::nullopt, walked(), 0.0, 12.0, clock_), kAskAgain);
  EXPECT_EQ(memory_.retries_used(), 1);
}

// A map that noise widens for ever must not give retries for ever.
TEST_F(Memory, EveryRestorationOfTheRetriesTakesTwiceTheArea) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  double explored = 10.0;
  const auto rounds_until_done = [&] {
    for (int rounds = 0;; ++rounds) {
      look(f, at(3.0, 5.05, 0.0), 4);
      if (memory_.judge(f, kFrame, std::nullopt, walked(), 0.0, explored, clock_) == kNothingLeft) {
        return rounds;
      }
    }
  };
  EXPECT_EQ(rounds_until_done(), 2);
  for (const double area : {1.0, 2.0, 4.0, 8.0}) {
    EXPECT_EQ(memory_.retry_area(), area);
    explored += 0.9 * area;
    EXPECT_EQ(rounds_until_done(), 0);
    explored += 0.2 * area;
    EXPECT_EQ(rounds_until_done(), 2);
  }
}

TEST_F(Memory, ATargetPutOffIsSuppressedAboutIt) {
  const std::vector<Frontier> f{frontier(20, 50, 30)};
  memory_.put_off_target(f, kFrame, walked());
  EXPECT_EQ(memory_.suppressed_count(), 0) << "no target yet";
  memory_.judge(f, kFrame, {{0, Cell{25, 50}}}, walked(), 5.0, 1.0, 0.0);
  memory_.put_off_target(f, kFrame, walked());
  EXPECT_TRUE(memory_.suppressed({20, 50}));
  EXPECT_TRUE(memory_.suppressed({35, 50}));
  EXPECT_FALSE(memory_.suppressed({36, 50})) << "more than a metre away";
  EXPECT_EQ(memory_.current_target(f, kFrame), -1);
  EXPECT_EQ(memory_.given_up(), 0);
}

// What was put off was not seen to fail. A rule that left a target for good after three losses
// ended missions with a third of the building seen, where the way to all the rest led past blank
// walls.
TEST_F(Memory, LossesDoNotUseUpTheRetriesButForFifty) {
  const std::vector<Frontier> f{frontier(20, 50, 30)};
  double stamp = 0.0;
  const auto lost_until_done = [&] {
    for (int losses = 0;; ++losses) {
      stamp += 1.0;
      memory_.judge(f, kFrame, {{0, Cell{25, 50}}}, walked(), 5.0, 10.0, stamp);
      memory_.put_off_target(f, kFrame, walked());
      if (memory_.judge(f, kFrame, std::nullopt, walked(), 0.0, 10.0, stamp) == kNothingLeft) {
        return losses;
      }
    }
  };
  // The first one finds all retries there; the last two have none to give back.
  EXPECT_EQ(lost_until_done(), 52);
}

// Two looks from one place that lose the localization each time: a robot turned from one to the
// other for 190 s, and the mission ended with a fifth of the building seen.
TEST_F(Memory, LossesAtOnePlaceUseUpTheRetriesButForThree) {
  const std::vector<Frontier> f{frontier(20, 50, 30)};
  double stamp = 0.0;
  const auto lost_until_done = [&](const Eigen::Vector2d& at) {
    for (int losses = 0;; ++losses) {
      stamp += 1.0;
      memory_.judge(f, kFrame, {{0, Cell{25, 50}}}, at, 5.0, 10.0, stamp);
      memory_.put_off_target(f, kFrame, at);
      if (memory_.judge(f, kFrame, std::nullopt, at, 0.0, 10.0, stamp) == kNothingLeft) {
        return losses;
      }
    }
  };
  EXPECT_EQ(lost_until_done({1.0, 2.0}), 5) << "two retries and three given back";
  EXPECT_EQ(lost_until_done({1.3, 2.0}), 0) << "the same place";
  EXPECT_EQ(lost_until_done({4.0, 2.0}), 3) << "another place";
}

TEST_F(Memory, NothingReachableAndNothingSuppressedIsDoneAtOnce) {
  EXPECT_EQ(memory_.judge({}, kFrame, std::nullopt, walked(), 0.0, 10.0, 0.0), kNothingLeft);
}

TEST_F(Memory, BadInputDoesNotCount) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  look(f, at(std::nan(""), 5.05, 0.0), 6);
  look(f, at(3.0, 5.05, std::nan("")), 6);
  EXPECT_EQ(memory_.suppressed_count(), 0);
  FrontierMemoryOptions bad;
  bad.progress.stalled_after = 9.0;
  EXPECT_THROW(FrontierMemory{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::frontier_memory_test

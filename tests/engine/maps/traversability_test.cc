// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/traversability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/known_extent.h"
#include "engine/support/resumable.h"
#include "tests/engine/ground_worlds.h"
#include "tests/engine/longest_piece.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::traversability_test {
namespace {

constexpr int kReach = 12;  // [cells] as far as twice the limit of what is kept

TEST(Traversability, EqualsTheDistanceToEveryCellOneByOne) {
  std::mt19937_64 random(1);
  for (const double r : {0.1, 0.05}) {
    GroundMap map(GridFrame{r, -16, -16, 32, 32});
    Traversability t(TraversabilityOptions{});
    for (int step = 0; step < 4; ++step) {
      test::scribble(map, 30, 40, -18 - 8 * step, random);
      t.update(map);
      const double limit = t.clearance_limit();
      EXPECT_GE(limit, t.options().comfortable_radius - 1e-9);
      int passable = 0, tight = 0, dear = 0;
      for (int k = 0; k < t.frame().size(); k += 7) {
        const Cell c = t.frame().at(k);
        const double occupied = test::slow_distance(map, c, CellState::kOccupied, kReach);
        const double unknown =
            std::min(test::slow_distance(map, c, CellState::kUnknown, kReach), limit);
        ASSERT_NEAR(t.clearance(c), std::min(occupied, limit), 1e-9);
        ASSERT_NEAR(t.unknown_clearance(c), unknown, 1e-9);
        const double slack = t.options().lattice_slack + 1e-9;
        const bool clear = occupied + slack >= t.options().hard_radius;
        ASSERT_EQ(t.clear(c), clear);
        const bool expected =
            map.state(c) == CellState::kFree && occupied > 0.0 &&
            occupied + slack + t.options().narrow_slack >= t.options().hard_radius;
        ASSERT_EQ(t.narrow(c), expected && !clear);
        ASSERT_EQ(t.passable(c), expected);
        if (!expected) continue;
        ++passable;
        double factor = 1.0;
        if (!clear) {
          factor *= 30.0;
        } else if (occupied + slack < t.options().comfortable_radius) {
          factor *= 4.0, ++tight;
        }
        if (unknown + slack < t.options().comfortable_radius) factor *= 1.5, ++dear;
        ASSERT_EQ(t.factor(c), static_cast<float>(factor));
      }
      EXPECT_GT(passable, 10);
      EXPECT_GT(tight, 0);
      EXPECT_GT(dear, 0);
    }
  }
}

TEST(Traversability, UpdatesEqualAFreshComputationBitForBit) {
  std::mt19937_64 random(2);
  for (int run = 0; run < 8; ++run) {
    GroundMap map(GridFrame{0.1, 0, 0, 64, 48});
    Traversability kept(TraversabilityOptions{});
    Grid<float> before;
    for (int step = 0; step < 12; ++step) {
      test::scribble(map, 6, 50 + 20 * step, -5 * step, random);
      kept.update(map);
      EXPECT_EQ(kept.restarted(), step == 0);
      Traversability fresh(TraversabilityOptions{});
      fresh.update(map);
      ASSERT_EQ(kept.frame(), fresh.frame());
      ASSERT_EQ(kept.factors().data, fresh.factors().data);
      ASSERT_EQ(kept.states().data, fresh.states().data);
      ASSERT_EQ(kept.explored_area(), fresh.explored_area());
      ASSERT_NEAR(kept.explored_area(), 0.01 * (map.free_cells() + map.occupied_cells()), 1e-9);
      Grid<char> listed(kept.frame(), 0);
      for (const Cell c : kept.changed_factors()) listed[c] = 1;
      for (int k = 0; k < kept.frame().size(); ++k) {
        const Cell c = kept.frame().at(k);
        ASSERT_EQ(kept.clearance(c), fresh.clearance(c));
        ASSERT_EQ(kept.unknown_clearance(c), fresh.unknown_clearance(c));
        // The list of changes is complete, and nothing else is on it.
        ASSERT_EQ(before.get(c, 0.0F) != kept.factor(c), listed[c] != 0);
      }
      before = kept.factors();
    }
  }
}

// A gap as wide as the robot's constraint demands is passable, also where its centre line lies on
// cell edges.
TEST(Traversability, IsNotStricterThanTheHardConstraintInAGap) {
  for (int width = 3; width <= 8; ++width) {
    GroundMap map(GridFrame{0.1, 0, 0, 48, 48});
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 48; ++i) {
        const bool wall = i == 24 && (j < 20 || j >= 20 + width);
        map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
      }
    }
    Traversability t(TraversabilityOptions{.hard_radius = 0.25, .comfortable_radius = 0.3});
    t.update(map);
    bool open = false;
    for (int j = 20; j < 20 + width; ++j) {
      open = open || (t.passable({24, j}) && !t.narrow({24, j}));
    }
    EXPECT_EQ(open, 0.1 * width >= 0.5 - 1e-9) << width;
  }
}

TEST(Traversability, AnotherMapStartsAfresh) {
  GroundMap first(GridFrame{0.1, 0, 0, 32, 32});
  for (int k = 0; k < 100; ++k) first.set({k % 20, k / 20}, CellState::kFree);
  GroundMap second(GridFrame{0.05, 0, 0, 32, 32});
  second.set({3, 3}, CellState::kOccupied);
  Traversability t(TraversabilityOptions{});
  t.update(first);
  t.update(second);
  EXPECT_TRUE(t.restarted());
  EXPECT_EQ(t.state({3, 3}), CellState::kOccupied);
  EXPECT_EQ(t.state({1, 1}), CellState::kUnknown);
  GroundMap earlier(GridFrame{0.05, 0, 0, 32, 32});
  EXPECT_TRUE(t.continues(earlier));
  t.update(earlier);
  EXPECT_FALSE(t.restarted());
  EXPECT_EQ(t.state({3, 3}), CellState::kUnknown);
  EXPECT_EQ(t.explored_area(), 0.0);
  GroundMap far(GridFrame{0.05, 1 << 20, 0, 32, 32});
  far.set({(1 << 20) + 3, 3}, CellState::kFree);
  EXPECT_FALSE(t.continues(far));
  t.update(far);
  EXPECT_TRUE(t.restarted());
  EXPECT_EQ(t.explored_area(), 0.05 * 0.05);
}

/// The cells of `map` in `frame`, in raster order: as a map projected anew counts them.
GroundMap projected(const GroundMap& map, const GridFrame& frame) {
  GroundMap anew(frame);
  for (int k = 0; k < frame.size(); ++k) {
    const Cell c = frame.at(k);
    anew.set(c, map.state(c), map.see_through(c));
  }
  return anew;
}

// Revisions tell nothing: maps come projected anew, grown, cut, shifted, or from elsewhere.
TEST(Traversability, AnyMapMayFollowAnyOther) {
  std::mt19937_64 random(7);
  Traversability kept(TraversabilityOptions{});
  GroundMap map(GridFrame{0.1, 0, 0, 96, 96});
  Grid<CellState> before;
  int continued = 0;
  for (int step = 0; step < 60; ++step) {
    const auto draw = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const int kind = step % 6;
    if (kind == 0) map = GroundMap(GridFrame{draw(3) == 0 ? 0.05 : 0.1, 0, 0, 96, 96});
    if (kind <= 1) test::scribble(map, 20, 90, 0, random);
    GridFrame frame = map.frame();
    if (kind == 2) frame = {frame.resolution, draw(40), draw(40), 20 + draw(60), 20 + draw(60)};
    if (kind == 3) frame.i0 -= draw(300), frame.width += 100;
    GroundMap given = projected(map, frame);
    if (kind == 4) {  // forgets a part of what it knew
      for (int k = draw(5); k < frame.size(); k += 5) given.set(frame.at(k), CellState::kUnknown);
      given = projected(given, frame);
    }
    const bool continues = kept.continues(given);
    kept.update(given);
    EXPECT_EQ(kept.restarted(), step == 0 || !continues);
    continued += continues;
    Traversability fresh(TraversabilityOptions{});
    fresh.update(given);
    ASSERT_EQ(kept.explored_area(), fresh.explored_area());
    std::set<std::pair<int, int>> listed, known;
    for (const Cell c : kept.changed_states()) listed.insert({c.j, c.i});
    for (const Cell c : kept.newly_known()) known.insert({c.j, c.i});
    const GridFrame& f = kept.frame();
    for (int k = 0; k < f.size(); ++k) {
      const Cell c = f.at(k);
      ASSERT_EQ(kept.state(c), given.state(c)) << step;
      ASSERT_EQ(kept.see_through().get(c, 0) != 0, given.see_through(c));
      ASSERT_EQ(kept.clearance(c), fresh.clearance(c)) << step;
      ASSERT_EQ(kept.unknown_clearance(c), fresh.unknown_clearance(c));
      ASSERT_EQ(kept.factor(c), fresh.factor(c));
      if (kept.restarted()) continue;
      const CellState was = before.get(c, CellState::kUnknown);
      ASSERT_EQ(was != kept.state(c), listed.contains({c.j, c.i}));
      ASSERT_EQ(was == CellState::kUnknown && kept.state(c) != was, known.contains({c.j, c.i}));
    }
    before = kept.states();
  }
  EXPECT_GT(continued, 40);
}

const BoxShape kLongBox{{0.05, 0.0, 0.3}, {0.9, 0.5, 0.4}};

TraversabilityOptions long_body() {
  const double radius = circumscribed_radius(kLongBox);
  return {.hard_radius = radius + 0.02, .comfortable_radius = radius + 0.17, .body = kLongBox};
}

// What is kept of a map followed its rectangle: one cell 500 m away made it 1.5 GB.
TEST(Traversability, IsAsLargeAsWhatIsKnown) {
  GroundMap ground({0.1, 0, 0, 32, 32});
  for (int n = 0; n < 32 * 32; ++n) ground.set({n % 32, n / 32}, CellState::kFree);
  Traversability without{TraversabilityOptions()};
  without.update(ground);
  ground.set({5000, -5000}, CellState::kOccupied);
  ASSERT_GT(ground.frame().size(), KnownExtent::kAlways);
  Traversability with{TraversabilityOptions()};
  with.update(ground);
  EXPECT_EQ(with.frame(), without.frame());
  EXPECT_EQ(with.factors().data, without.factors().data);
  EXPECT_EQ(with.state({5000, -5000}), CellState::kUnknown);
}

TEST(Traversability, ALongBodyFitsWhereSomeHeadingDoes) {
  std::mt19937_64 random(5);
  const std::vector<OutlinePart> outline = ground_outline(kLongBox);
  for (const double r : {0.1, 0.08}) {
    GroundMap map(GridFrame{r, -16, -16, 64, 64});
    Traversability t(long_body());
    int roomy = 0, between = 0, none = 0;
    for (int step = 0; step < 3; ++step) {
      test::scribble(map, 12, 60, -18 - 8 * step, random);
      t.update(map);
      for (int k = 0; k < t.frame().size(); k += 5) {
        const Cell c = t.frame().at(k);
        int headings = 0;
        const int reach = static_cast<int>(0.7 / r);
        for (int heading = 0; heading < kHeadings; ++heading) {
          double least = 1.0;
          for (int j = c.j - reach; j <= c.j + reach; ++j) {
            for (int i = c.i - reach; i <= c.i + reach; ++i) {
              if (map.state({i, j}) != CellState::kOccupied) continue;
              least = std::min(least, outline_distance(outline, t.frame().center(c),
                                                       heading_at(heading), {i * r, j * r}, r));
            }
          }
          headings += least + t.options().lattice_slack + 1e-9 >= 0.02;
        }
        ASSERT_EQ(t.clear(c), headings > 0);
        const bool expected = map.state(c) == CellState::kFree && headings > 0;
        ASSERT_EQ(t.passable(c), expected);
        ASSERT_EQ(t.fits(c), expected);
        if (map.state(c) != CellState::kFree) continue;
        ++(headings == kHeadings ? roomy : headings > 0 ? between : none);
      }
    }
    EXPECT_GT(roomy, 10);
    EXPECT_GT(between, 10);
    EXPECT_GT(none, 10);
  }
}

TEST(Traversability, OfALongBodyUpdatesEqualAFreshComputationBitForBit) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(12);
  int closed_off = 0;
  for (int run = 0; run < 6; ++run) {
    GroundMap map(GridFrame{0.1, 0, 0, 64, 48});
    TraversabilityOptions options = long_body();
    options.free_moves = run % 2 == 0;
    Traversability kept(options);
    Grid<float> before;
    Grid<HeadingMask> turnable;
    for (int step = 0; step < 10; ++step) {
      test::scribble(map, 5, 90 + 20 * step, -5 * step, random);
      const Pose pose{{0.1 * static_cast<double>(random() % 60), 2.3, 0.0}, 0.4 * step};
      kept.update(map, &pose);
      Traversability fresh(options), everywhere(options);
      fresh.update(map, &pose);
      everywhere.update(map);
      ASSERT_EQ(kept.factors().data, fresh.factors().data);
      Grid<char> listed(kept.frame(), 0);
      for (const Cell c : kept.changed_factors()) listed[c] = 1;
      Grid<char> relisted(kept.frame(), 0);
      for (const Cell c : kept.changed_headings()) relisted[c] = 1;
      for (int k = 0; k < kept.frame().size(); ++k) {
        const Cell c = kept.frame().at(k);
        ASSERT_EQ(before.get(c, 0.0F) != kept.factor(c), listed[c] != 0);
        ASSERT_EQ(kept.fits(c), everywhere.passable(c));
        ASSERT_TRUE(kept.fits(c) || !kept.passable(c));
        closed_off += kept.fits(c) && !kept.passable(c);
        bool turned = false;
        for (int h = 0; h < kHeadings; ++h) {
          const bool now = kept.turns_to(static_cast<std::size_t>(k), HeadingMask{1} << h);
          ASSERT_EQ(now, fresh.turns_to(static_cast<std::size_t>(k), HeadingMask{1} << h));
          const HeadingMask was = turnable.get(c, kNoHeading);
          turned = turned || now != (((was >> h) & 1U) != 0);
        }
        ASSERT_EQ(turned, relisted[c] != 0);
      }
      before = kept.factors();
      turnable = Grid<HeadingMask>(kept.frame(), kNoHeading);
      for (int k = 0; k < kept.frame().size(); ++k) {
        for (int h = 0; h < kHeadings; ++h) {
          const HeadingMask bit = HeadingMask{1} << h;
          if (kept.turns_to(static_cast<std::size_t>(k), bit)) {
            turnable.data[static_cast<std::size_t>(k)] |= bit;
          }
        }
      }
    }
  }
  EXPECT_GT(closed_off, 1000);
}

/// Two rooms of 4 x 4 m, joined by a passage 9 cells wide and `length` cells long.
GroundMap two_rooms(int length, int width = 9) {
  GroundMap map(GridFrame{0.1, 0, 0, 96 + length, 48});
  for (int j = 0; j < 48; ++j) {
    for (int i = 0; i < 88 + length; ++i) {
      const bool in_a_room = (i >= 4 && i < 44) || (i >= 44 + length && i < 84 + length);
      const bool room = in_a_room && j >= 4 && j < 44;
      const bool passage = i >= 44 && i < 44 + length && j >= 20 && j < 20 + width;
      map.set({i, j}, room || passage ? CellState::kFree : CellState::kOccupied);
    }
  }
  return map;
}

TEST(Traversability, ALongBodyGoesThroughDoorsAndCorridorsLengthways) {
  const Pose pose{{2.4, 2.4, 0.0}, 1.0};
  for (const int length : {2, 40}) {
    const GroundMap map = two_rooms(length);
    Traversability t(long_body());
    t.update(map, &pose);
    EXPECT_TRUE(t.passable({45, 24}));
    EXPECT_TRUE(t.passable({64 + length, 24})) << "the room behind";
    const auto in_passage = static_cast<std::size_t>(t.frame().index({44 + length / 2, 24}));
    EXPECT_TRUE(t.turns_to(in_passage, t.facing(0.0)));
    EXPECT_TRUE(t.turns_to(in_passage, t.facing(M_PI)));
    EXPECT_FALSE(t.turns_to(in_passage, t.facing(M_PI / 2.0)));
    const auto in_room = static_cast<std::size_t>(t.frame().index({24, 24}));
    EXPECT_TRUE(t.turns_to(in_room, t.facing(M_PI / 2.0)));
    // By its circumscribed radius alone it does not.
    TraversabilityOptions round = long_body();
    round.body.reset();
    Traversability disc(round);
    disc.update(map, &pose);
    EXPECT_FALSE(disc.passable({45, 24}));
    // Too narrow for its width: the room behind fits, but is out of reach.
    const GroundMap narrow = two_rooms(length, 4);
    Traversability shut(long_body());
    shut.update(narrow, &pose);
    EXPECT_FALSE(shut.passable({45, 22}));
    EXPECT_FALSE(shut.passable({64 + length, 24}));
    EXPECT_TRUE(shut.fits({64 + length, 24}));
    EXPECT_TRUE(shut.passable({20, 24}));
  }
}

TEST(Traversability, WhatIsClosedShutsALongBodyOut) {
  const GroundMap map = two_rooms(10);
  const Pose pose{{2.4, 2.4, 0.0}, 1.0};
  Traversability t(long_body());
  t.update(map, &pose);
  ASSERT_TRUE(t.passable({74, 24}));
  t.close({48, 24}, 0.3);
  EXPECT_FALSE(t.passable({48, 24}));
  EXPECT_FALSE(t.fits({48, 24}));
  t.update(map, &pose);
  EXPECT_FALSE(t.passable({74, 24}));
  EXPECT_TRUE(t.fits({74, 24}));
}

TEST(Traversability, BadOptionsAreNamed) {
  try {
    Traversability t(TraversabilityOptions{.hard_radius = 0.4, .comfortable_radius = 0.3});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("comfortable_radius is 0.3"), std::string::npos)
        << e.what();
  }
  EXPECT_THROW(Traversability(TraversabilityOptions{.hard_radius = std::nan("")}),
               std::invalid_argument);
  TraversabilityOptions thin = long_body();
  thin.hard_radius = 0.3;
  EXPECT_THROW(Traversability{thin}, std::invalid_argument);
}

// Lists that grew by being moved, and the reach of a long body, took tens of milliseconds at once.
TEST(Traversability, PausesOftenHoweverLargeTheMap) {
  struct Row {
    int side;  // [cells]
    bool heading_matters;
    double most;  // of the whole, at once
  };
  for (const Row& row : {Row{1500, false, 0.1}, Row{500, true, 0.25}}) {
    GroundMap map(GridFrame{0.1, 0, 0, row.side, row.side});
    for (int j = 0; j < row.side; ++j) {
      for (int i = 0; i < row.side; ++i) map.set({i, j}, CellState::kFree);
    }
    TraversabilityOptions options;
    if (row.heading_matters) {
      options.body = BoxShape{{0.0, 0.0, 0.2}, {0.6, 0.3, 0.3}};
      options.hard_radius = options.comfortable_radius = 0.4;
    }
    Pose pose;
    pose.position = {10.0, 10.0, 0.0};
    const double longest = test::longest_piece([&](const PausePoint& pause) {
      Traversability t(options);
      t.update(map, &pose, pause);
      EXPECT_TRUE(t.passable({100, 100}));
    });
    EXPECT_LT(longest, row.most) << row.side;
  }
}

}  // namespace
}  // namespace prospect::traversability_test

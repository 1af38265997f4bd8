// SPDX-License-Identifier: Apache-2.0
#include "runtime/stream_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace prospect::stream_watch_test {
namespace {

TEST(StreamWatch, CountsFromWhenAStreamCameWithinItsLimit) {
  StreamWatch watch({{"cameras", 0.0, 0.5}, {"depth", 0.0, 1.0}}, 100.0);
  EXPECT_FALSE(watch.live_for(0.0));
  EXPECT_TRUE(std::isinf(watch.streams()[0].age));
  struct Row {
    double now;
    std::optional<double> cameras, depth;
    double cameras_live, depth_live;
  };
  for (const Row& r : std::vector<Row>{
           {100.2, 100.1, std::nullopt, 0.2, 0.0},
           {100.4, 100.3, 100.0, 0.4, 0.2},
           {101.0, 100.3, 100.0, 0.0, 0.8},         // 0.7 s is too old for a camera
           {101.2, 101.1, 100.3, 0.2, 1.0},         //
           {101.4, std::nan(""), 100.5, 0.0, 1.2},  // a stamp that is no number is no life
           {102.0, 101.9, 100.5, 0.6, 0.0},
       }) {
    watch.look(0, r.cameras, r.now);
    watch.look(1, r.depth, r.now);
    EXPECT_NEAR(watch.streams()[0].live_for, r.cameras_live, 1e-9) << r.now;
    EXPECT_NEAR(watch.streams()[1].live_for, r.depth_live, 1e-9) << r.now;
    EXPECT_EQ(watch.live_for(0.3), r.cameras_live > 0.3 && r.depth_live > 0.3) << r.now;
  }
}

TEST(StreamWatch, WithoutStreamsNothingIsMissing) {
  EXPECT_TRUE(StreamWatch({}, 0.0).live_for(1.0));
}

}  // namespace
}  // namespace prospect::stream_watch_test

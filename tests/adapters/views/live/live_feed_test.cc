// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/live_feed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace prospect::live_feed_test {
namespace {

TEST(LiveFeed, StepsComeInOrderAndOnceAndOthersAsTheNewest) {
  LiveFeed feed;
  for (int k = 0; k < 5; ++k) {
    StepRecord step;
    step.step = k;
    feed.on_record(step, {});
    Belief belief;
    belief.stamp = k;
    feed.on_belief(belief);
  }
  LiveFeed::News news = feed.take(true);
  ASSERT_EQ(news.steps.size(), 5U);
  EXPECT_EQ(news.steps.back()->step, 4);
  ASSERT_TRUE(news.pose);
  EXPECT_EQ(news.pose->stamp, 4.0);
  news = feed.take(true);
  EXPECT_TRUE(news.steps.empty());
  EXPECT_FALSE(news.pose);
}

TEST(LiveFeed, PicturesAreTakenOnlyWhereSomebodyWatches) {
  LiveFeed feed;
  const CameraPicture shown{std::make_shared<const Image>(8, 4, 7), {}};
  feed.on_picture(shown);
  EXPECT_FALSE(feed.take(true).picture);
  feed.on_picture(shown);
  feed.on_picture(shown);
  const auto picture = feed.take(false).picture;
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->image, shown.image);
  feed.on_picture(shown);
  EXPECT_FALSE(feed.take(false).picture);
}

TEST(LiveFeed, WhatNobodyTakesIsBoundedAndCounted) {
  LiveFeed feed;
  const int all = static_cast<int>(LiveFeed::kMost) + 20;
  for (int k = 0; k < all; ++k) {
    StepRecord step;
    step.step = k;
    feed.on_record(step, {});
  }
  const LiveFeed::News news = feed.take(false);
  ASSERT_EQ(news.steps.size(), LiveFeed::kMost);
  EXPECT_EQ(news.steps.front()->step, 20);
  EXPECT_EQ(news.dropped, 20U);
  EXPECT_EQ(feed.take(false).dropped, 20U) << "of all that have come";
}

TEST(LiveFeed, ThreadsThatTellAndOneThatTakesLoseNothing) {
  constexpr int kSteps = 2000;
  LiveFeed feed;
  std::atomic<bool> over = false;
  int taken = 0;
  std::thread reader([&] {
    for (bool last = false; !last;) {
      last = over;
      for (const auto& step : feed.take(true).steps) EXPECT_EQ(step->step, taken++);
    }
  });
  std::thread perception([&] {
    for (int k = 0; k < kSteps; ++k) feed.on_belief({});
  });
  for (int k = 0; k < kSteps; ++k) {
    StepRecord step;
    step.step = k;
    feed.on_record(step, {});
  }
  perception.join();
  over = true;
  reader.join();
  EXPECT_EQ(taken, kSteps);
}

}  // namespace
}  // namespace prospect::live_feed_test

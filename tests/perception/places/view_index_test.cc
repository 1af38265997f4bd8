// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace prospect::view_index_test {
namespace {

StereoView random_view(std::mt19937_64& generator, int points) {
  StereoView view;
  for (int n = 0; n < points; ++n) {
    StereoView::Point point;
    for (auto& word : point.descriptor) word = generator();
    view.points.push_back(point);
  }
  return view;
}

/// The same view with each bit turned with this probability.
StereoView seen_again(StereoView view, double turned, std::mt19937_64& generator) {
  for (StereoView::Point& point : view.points) {
    for (auto& word : point.descriptor) {
      for (int bit = 0; bit < 64; ++bit) {
        if (static_cast<double>(generator() >> 11) * 0x1p-53 < turned)
          word ^= std::uint64_t{1} << bit;
      }
    }
  }
  return view;
}

TEST(ViewIndex, AViewThatComesAgainGetsTheVotes) {
  std::mt19937_64 generator(3);
  ViewIndex index;
  std::vector<StereoView> views;
  for (int k = 0; k < 100; ++k) {
    views.push_back(random_view(generator, 200));
    index.add(views.back());
  }
  for (const int k : {0, 17, 50, 99}) {
    const std::vector<int> votes =
        index.votes(seen_again(views[static_cast<std::size_t>(k)], 0.08, generator));
    ASSERT_EQ(votes.size(), 100U);
    const auto best = std::max_element(votes.begin(), votes.end());
    EXPECT_EQ(best - votes.begin(), k);
    EXPECT_GT(*best, 60);  // of 200: each of some eight bits asked for may be turned
    // Others hardly get any.
    std::vector<int> others = votes;
    others[static_cast<std::size_t>(k)] = 0;
    EXPECT_LE(*std::max_element(others.begin(), others.end()), 2);
  }
}

TEST(ViewIndex, AlikeDescriptorsStayInOneLeaf) {
  StereoView same;
  same.points.resize(500);
  ViewIndex index;
  index.add(same);
  index.add(same);
  const std::vector<int> votes = index.votes(same);
  EXPECT_EQ(votes, (std::vector<int>{500, 500}));
  EXPECT_EQ(index.views(), 2);
}

TEST(ViewIndex, EmptyViewsCount) {
  ViewIndex index;
  EXPECT_TRUE(index.votes({}).empty());
  index.add({});
  EXPECT_EQ(index.votes({}), std::vector<int>{0});
}

}  // namespace
}  // namespace prospect::view_index_test

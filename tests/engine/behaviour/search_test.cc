#include "engine/behaviour/search.h"

#include <gtest/gtest.h>

namespace prospect::search_test {
namespace {

using enum Search;

TEST(Search, EveryRowOfTheTableDecides) {
  const SearchFacts grown{.new_ground = true}, nothing{.nothing_reachable = true};
  const SearchFacts closed{.nothing_reachable = true, .passage_closed = true, .may_reopen = true};
  struct Case {
    Search from;
    SearchFacts facts;
  };
  const Case cases[] = {{kShortFrontiers, grown},
                        {kNarrowPassages, grown},
                        {kOrdinary, nothing},
                        {kShortFrontiers, nothing},
                        {kNarrowPassages, closed}};
  ASSERT_EQ(std::size(cases), search_table().size());
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    EXPECT_EQ(next_search(cases[i].from, cases[i].facts), &search_table()[i]) << i;
  }
}

TEST(Search, NothingChangesWithoutReason) {
  for (const Search search : {kOrdinary, kShortFrontiers, kNarrowPassages}) {
    EXPECT_EQ(next_search(search, {}), nullptr);
    EXPECT_EQ(next_search(search, {.passage_closed = true, .may_reopen = true}), nullptr);
  }
  EXPECT_EQ(next_search(kOrdinary, {.new_ground = true}), nullptr);
  EXPECT_EQ(next_search(kNarrowPassages, {.nothing_reachable = true}), nullptr) << "exhausted";
  EXPECT_EQ(next_search(kNarrowPassages, {.nothing_reachable = true, .passage_closed = true}),
            nullptr)
      << "opened as often as may be";
}

}  // namespace
}  // namespace prospect::search_test

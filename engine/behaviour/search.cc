#include "engine/behaviour/search.h"

#include <array>

namespace prospect {
namespace {

constexpr std::array kSearchTable = {
    SearchRow{Search::kShortFrontiers, "new ground was seen",
              [](const SearchFacts& f) { return f.new_ground; }, Search::kOrdinary, false},
    SearchRow{Search::kNarrowPassages, "new ground was seen",
              [](const SearchFacts& f) { return f.new_ground; }, Search::kOrdinary, false},
    SearchRow{Search::kOrdinary, "nothing is reachable",
              [](const SearchFacts& f) { return f.nothing_reachable; }, Search::kShortFrontiers,
              false},
    SearchRow{Search::kShortFrontiers, "nothing is reachable",
              [](const SearchFacts& f) { return f.nothing_reachable; }, Search::kNarrowPassages,
              true},
    SearchRow{Search::kNarrowPassages,
              "nothing is reachable, passages were closed and may be opened once more",
              [](const SearchFacts& f) {
                return f.nothing_reachable && f.passage_closed && f.may_reopen;
              },
              Search::kNarrowPassages, true},
};

}  // namespace

std::string_view to_string(Search search) {
  switch (search) {
    case Search::kOrdinary:
      return "ordinary";
    case Search::kShortFrontiers:
      return "short frontiers";
    case Search::kNarrowPassages:
      return "narrow passages";
  }
  return "?";
}

std::span<const SearchRow> search_table() { return kSearchTable; }

const SearchRow* next_search(Search from, const SearchFacts& facts) {
  for (const SearchRow& row : kSearchTable) {
    if (row.from == from && row.holds(facts)) return &row;
  }
  return nullptr;
}

}  // namespace prospect

#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace prospect {

/// Which frontiers count. Each admits more than the one before: what a robot sees of a room through
/// a slit is a short frontier, and walls drawn twice by a drifting estimate close real doors.
enum class Search {
  kOrdinary,        ///< those of full length, through passages of full width
  kShortFrontiers,  ///< shorter ones, too
  kNarrowPassages   ///< behind passages that are too narrow by the map, too
};

/// "ordinary", "short frontiers", "narrow passages".
std::string_view to_string(Search search);

struct SearchFacts {
  bool nothing_reachable = false;  ///< of what counts at present
  bool new_ground = false;         ///< more was explored since kOrdinary was left than what is left
                                   ///< at the end of a mission shows
  bool passage_closed = false;     ///< a narrow passage was given up since all were last opened
  bool may_reopen = false;         ///< those may be opened once more
};

/// A row of the table: in order of precedence, the first that holds is taken.
struct SearchRow {
  Search from;
  std::string_view condition;
  bool (*holds)(const SearchFacts&);
  Search to;
  bool try_all_again;  ///< what was given up
};

std::span<const SearchRow> search_table();

/// The row to take from `from`; null: nothing changes. Pure.
const SearchRow* next_search(Search from, const SearchFacts& facts);

}  // namespace prospect

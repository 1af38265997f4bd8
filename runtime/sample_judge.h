// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <utility>

namespace prospect {

/// Whether a source is bad, by its samples: one bad sample decides nothing, several do, for every
/// source alike. A bad one adds 2 to a count, a good one takes 1 away, which stays within 0 and 6;
/// from 5 on the source is bad: by three bad ones in a row, or four of seven. What is bad is left
/// out by whoever asks. Thread-safety: one thread at a time.
class SampleJudge {
 public:
  void good() { count_ = std::max(0, count_ - 1); }
  /// why: one line.
  void bad(std::string why) {
    count_ = std::min(kMost, count_ + 2);
    why_ = std::move(why);
  }
  bool is_bad() const { return count_ >= kBad; }
  /// Of the newest bad sample; empty: the source is not bad.
  std::string fault() const { return is_bad() ? why_ : std::string(); }

 private:
  static constexpr int kBad = 5, kMost = 6;
  int count_ = 0;
  std::string why_;
};

}  // namespace prospect

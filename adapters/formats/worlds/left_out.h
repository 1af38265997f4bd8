// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace prospect {

/// What a loader read past because it does not matter for exploring, or could not be had: kinds
/// that are counted ("sphere collision") and single things that are named ("texture 'a.png'
/// (absent)"). Text of a file in it is made printable and cut by the caller, or by in_quotes(). A
/// value.
class LeftOut {
 public:
  /// One more of a kind, in the singular.
  void count(const std::string& kind, std::size_t times = 1);
  /// A thing with its own words; once, however often it is named.
  void name(const std::string& words);
  void add(const LeftOut& other);
  bool empty() const { return items_.empty(); }
  /// (0: named, else counted; words), in the order of first mention.
  const std::vector<std::pair<std::size_t, std::string>>& items() const { return items_; }
  /// "2 sphere collisions, 1 sun, texture 'a.png' (absent)"; from the 13th item on only how many
  /// (of more than a thousand, which are not told apart, at least). Empty if nothing was left out.
  std::string text() const;

 private:
  std::vector<std::pair<std::size_t, std::string>> items_;
};

/// Text of a file for a message: in quotes, one line, at most 60 bytes.
std::string in_quotes(const std::string& text);

/// A length or height for a message, three digits.
std::string metres(double value);

}  // namespace prospect

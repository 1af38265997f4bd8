// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/left_out.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace prospect {
namespace {

/// Nobody reads more of them, and each is looked for among the others.
constexpr std::size_t kMostItems = 1000;

}  // namespace

void LeftOut::count(const std::string& kind, std::size_t times) {
  if (times == 0) return;
  const auto known = std::find_if(items_.begin(), items_.end(), [&](const auto& item) {
    return item.first > 0 && item.second == kind;
  });
  if (known != items_.end()) {
    known->first += times;
  } else if (items_.size() < kMostItems) {
    items_.emplace_back(times, kind);
  }
}

void LeftOut::name(const std::string& words) {
  if (items_.size() >= kMostItems) return;
  const std::pair<std::size_t, std::string> item(0, words);
  if (std::find(items_.begin(), items_.end(), item) == items_.end()) items_.push_back(item);
}

void LeftOut::add(const LeftOut& other) {
  for (const auto& [times, words] : other.items_) {
    if (times > 0) {
      count(words, times);
    } else {
      name(words);
    }
  }
}

std::string LeftOut::text() const {
  constexpr std::size_t kMost = 12;
  std::string out;
  for (std::size_t n = 0; n < std::min(kMost, items_.size()); ++n) {
    const auto& [times, words] = items_[n];
    out += out.empty() ? "" : ", ";
    out += times > 0 ? std::to_string(times) + " " + words + (times > 1 ? "s" : "") : words;
  }
  if (items_.size() > kMost) out += " and " + std::to_string(items_.size() - kMost) + " more";
  return out;
}

std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text.substr(0, 60)) {
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return out + (text.size() > 60 ? "...'" : "'");
}

std::string metres(double value) {
  std::ostringstream out;
  if (std::abs(value) >= 100.0 && std::abs(value) < 1e9) {
    out << std::llround(value);
    return out.str();
  }
  out.precision(3);
  out << (std::abs(value) < 5e-4 ? 0.0 : value);
  return out.str();
}

}  // namespace prospect

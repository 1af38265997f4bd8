// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_index.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

namespace prospect {
namespace {

constexpr int kBits = 256;

bool bit_of(const ViewDescriptor& descriptor, int bit) {
  return (descriptor[static_cast<std::size_t>(bit / 64)] >> (bit % 64) & 1) != 0;
}

}  // namespace

int ViewIndex::leaf_of(const ViewDescriptor& descriptor) const {
  int node = 0;
  for (int bit = nodes_[0].bit; bit >= 0; bit = nodes_[static_cast<std::size_t>(node)].bit) {
    node = nodes_[static_cast<std::size_t>(node)].children[bit_of(descriptor, bit)];
  }
  return node;
}

void ViewIndex::split(int leaf) {
  const std::vector<Entry>& entries = nodes_[static_cast<std::size_t>(leaf)].entries;
  const int n = static_cast<int>(entries.size());
  std::array<int, kBits> ones = {};
  for (const Entry& entry : entries) {
    for (int bit = 0; bit < kBits; ++bit)
      ones[static_cast<std::size_t>(bit)] += bit_of(entry.descriptor, bit);
  }
  int best = 0;
  for (int bit = 1; bit < kBits; ++bit) {
    if (std::abs(2 * ones[static_cast<std::size_t>(bit)] - n) <
        std::abs(2 * ones[static_cast<std::size_t>(best)] - n)) {
      best = bit;
    }
  }
  // One that leaves a tenth on a side tells little, and costs whoever has it turned by noise.
  const int rarer =
      std::min(ones[static_cast<std::size_t>(best)], n - ones[static_cast<std::size_t>(best)]);
  if (10 * rarer < n) return;
  std::vector<Entry> moved = std::exchange(nodes_[static_cast<std::size_t>(leaf)].entries, {});
  const int first = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  Node& node = nodes_[static_cast<std::size_t>(leaf)];
  node.bit = best;
  node.children[0] = first;
  node.children[1] = first + 1;
  for (Entry& entry : moved) {
    nodes_[static_cast<std::size_t>(first + bit_of(entry.descriptor, best))].entries.push_back(
        entry);
  }
}

void ViewIndex::add(const StereoView& view) {
  for (const StereoView::Point& point : view.points) {
    const int leaf = leaf_of(point.descriptor);
    std::vector<Entry>& entries = nodes_[static_cast<std::size_t>(leaf)].entries;
    entries.push_back({point.descriptor, views_});
    // Not at each one that a leaf gets which no bit halves.
    if (entries.size() % kLeaf == 1 && entries.size() > kLeaf) split(leaf);
  }
  ++views_;
}

std::vector<int> ViewIndex::votes(const StereoView& view) const {
  std::vector<int> votes(static_cast<std::size_t>(views_), 0);
  std::vector<int> voted(votes.size(), -1);  // by which point last
  for (int i = 0; i < static_cast<int>(view.points.size()); ++i) {
    const ViewDescriptor& descriptor = view.points[static_cast<std::size_t>(i)].descriptor;
    for (const Entry& entry : nodes_[static_cast<std::size_t>(leaf_of(descriptor))].entries) {
      const auto k = static_cast<std::size_t>(entry.view);
      if (voted[k] == i || distance(entry.descriptor, descriptor) > kNear) continue;
      voted[k] = i;
      ++votes[k];
    }
  }
  return votes;
}

}  // namespace prospect

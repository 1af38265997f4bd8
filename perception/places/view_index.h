// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "perception/places/stereo_view.h"

namespace prospect {

/// Which of many views shows the same as a new one: a binary tree over their descriptors that grows
/// with them. It needs no vocabulary that was learned from other images.
///
/// A node asks for one bit. A leaf that holds more than kLeaf descriptors is split by the bit that
/// halves them best; it stays whole where no bit does. A descriptor that is looked up goes down by
/// its own bits, and gives one vote to each view of which the leaf holds a descriptor that differs
/// in at most kNear bits. So a look-up costs about log2(n / kLeaf) + kLeaf comparisons, n
/// descriptors in all; a descriptor is missed where noise turned one of the bits asked for.
///
/// Retrieval only proposes: views of places that look alike get votes, too (view_alignment.h
/// decides). Source: Schlegel and Grisetti, HBST, 2018. Deterministic. Thread-safety: as a value.
class ViewIndex {
 public:
  static constexpr std::size_t kLeaf = 100;
  static constexpr int kNear = 40;  ///< of 256 bits

  /// Views are numbered from 0 in the order in which they come.
  void add(const StereoView& view);
  /// Votes for each view so far.
  std::vector<int> votes(const StereoView& view) const;
  int views() const { return views_; }

 private:
  struct Entry {
    ViewDescriptor descriptor;
    int view;
  };
  struct Node {
    int bit = -1;  ///< -1: a leaf
    int children[2] = {-1, -1};
    std::vector<Entry> entries;  ///< of a leaf
  };

  int leaf_of(const ViewDescriptor& descriptor) const;
  void split(int leaf);

  std::vector<Node> nodes_ = std::vector<Node>(1);
  int views_ = 0;
};

}  // namespace prospect

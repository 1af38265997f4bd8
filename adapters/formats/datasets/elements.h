// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {

/// Elements of one kind in a recording, read one by one: poses, images, scans, calibrations. One
/// that is bad (no pose, an image that cannot be decoded, a message that ends early) is left out
/// and counted, whatever the layout; where more than half of them are bad, it is the recording that
/// is.
class Elements {
 public:
  /// `kind` in the plural, for messages: "poses of /odom".
  explicit Elements(std::string kind) : kind_(std::move(kind)) {}

  /// Calls `take`. False where that throws InputError: this element is left out.
  template <typename Take>
  bool read(const Take& take) {
    ++all_;
    try {
      take();
      return true;
    } catch (const InputError& error) {
      why_ = error.lines()[0];
    }
    if (bad_++ == 0) first_ = why_;
    return false;
  }

  int all() const { return all_; }
  int bad() const { return bad_; }
  /// Why the first and the newest of those that are bad are.
  const std::string& first() const { return first_; }
  const std::string& why() const { return why_; }
  /// "1 of 8 poses of /odom left out: /odom message 3: not a pose; ..."; the first one's reason.
  /// Empty if none is bad.
  std::string note() const {
    if (bad_ == 0) return {};
    return std::to_string(bad_) + " of " + std::to_string(all_) + " " + kind_ + " left out" +
           (bad_ > 1 ? ", the first: " : ": ") + first_;
  }
  /// Adds note(), if there is one. Throws InputError, the first one's line, if more than half of
  /// them are bad.
  void finish(std::vector<std::string>& notes) const {
    if (2 * bad_ > all_) throw InputError(first_);
    if (bad_ > 0) notes.push_back(note());
  }

 private:
  std::string kind_, first_, why_;
  int all_ = 0, bad_ = 0;
};

}  // namespace prospect

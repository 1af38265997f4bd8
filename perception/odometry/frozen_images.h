// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "models/image.h"

namespace prospect {

/// Notices images that come twice. A sensor never gives the same noise again: the same bytes are an
/// old image, not a robot at rest.
class FrozenImages {
 public:
  /// Which of the images are those kept last, in words; empty: neither.
  std::string find(const ImageView& left, const ImageView& right) const;
  /// Copies them.
  void keep(const ImageView& left, const ImageView& right);
  /// The copies; nobody changes them any more.
  const std::shared_ptr<const Image>& left() const { return left_; }
  const std::shared_ptr<const Image>& right() const { return right_; }

 private:
  std::shared_ptr<const Image> left_, right_;
};

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// A cost-to-go, small enough for a page.
struct FieldPicture {
  GridFrame frame;    ///< of the pixels, y up; empty: there is nothing to show
  double most = 0.0;  ///< [s], of a pixel of 255
  /// Grey, 8 bit, y down: 0 where there is no value, else 1 + 254 seconds / most, rounded.
  std::vector<std::uint8_t> png;
};

/// At most about `max_pixels`: a pixel is a block of cells, aligned in W, and has the lowest value
/// in it. Values that are negative or not finite count as none.
FieldPicture field_picture(const CostToGoPicture& picture, int max_pixels = 40'000);

}  // namespace prospect

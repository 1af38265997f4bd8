// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// What becomes of a field of a message or file that comes in.
enum class FieldUse {
  kUsed,      ///< what it says is taken into account
  kChecked,   ///< held against what else is known: refused where that contradicts it
  kRefused,   ///< refused if it says anything but the usual
  kNotNeeded  ///< it says nothing that matters here, and `why`
};

/// A row of a table in which each field of a format stands once.
struct FieldRule {
  const char* name;  ///< "roi.x_offset"; of a sequence, "fields.name"
  FieldUse use;
  const char* why = "";
};

}  // namespace prospect

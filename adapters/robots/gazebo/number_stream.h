// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <locale>
#include <sstream>

namespace prospect {

/// A stream that writes numbers as files of Gazebo hold them: a point, nine digits, whatever the
/// program's locale.
inline std::ostringstream number_stream() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  return out;
}

}  // namespace prospect

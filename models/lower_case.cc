// SPDX-License-Identifier: Apache-2.0
#include "models/lower_case.h"

#include <cctype>

namespace prospect {

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "models/parameter_check.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace prospect {

void check_parameter(bool ok, std::string_view owner, std::string_view name, double value,
                     std::string_view expected) {
  if (ok) return;
  std::ostringstream message;
  message << owner << ": " << name << " is " << value << "; expected " << expected;
  throw std::invalid_argument(message.str());
}

void check_positive(std::string_view owner, std::string_view name, double value) {
  check_parameter(std::isfinite(value) && value > 0.0, owner, name, value,
                  "a finite number greater than 0");
}

void check_not_negative(std::string_view owner, std::string_view name, double value) {
  check_parameter(std::isfinite(value) && value >= 0.0, owner, name, value,
                  "a finite number not less than 0");
}

void check_finite(std::string_view owner, std::string_view name, double value) {
  check_parameter(std::isfinite(value), owner, name, value, "a finite number");
}

}  // namespace prospect

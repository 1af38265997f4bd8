#pragma once

#include <string>

namespace prospect::csv {

/// The shortest text that reads back as the same number; nan, inf or -inf where it is not finite.
std::string text(double value);

/// A CSV field (RFC 4180), kept on one line: quoted if it must be.
std::string field(const std::string& value);

}  // namespace prospect::csv

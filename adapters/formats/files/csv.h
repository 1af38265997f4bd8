// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect::csv {

/// A CSV field (RFC 4180), kept on one line: quoted if it must be.
std::string field(const std::string& value);

}  // namespace prospect::csv

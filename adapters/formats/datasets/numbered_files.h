// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace prospect {

/// The files of a folder whose names are `prefix`, digits, `suffix`: number and path, by number.
/// Hidden ones are passed over.
/// Throws InputError, one line: no such folder, no such file, or a file that ends in `suffix` but
/// is not named so.
std::vector<std::pair<std::uint64_t, std::string>> numbered_files(const std::string& folder,
                                                                  const std::string& prefix,
                                                                  const std::string& suffix);

/// All bytes of a file, without a mark of byte order (UTF-8) at its beginning. Throws InputError if
/// it cannot be read.
std::string read_whole_file(const std::string& path);

}  // namespace prospect

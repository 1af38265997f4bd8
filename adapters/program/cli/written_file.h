// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "adapters/formats/files/output_folder.h"

namespace prospect {

/// Writes a file of the folder. Throws InputError, one line that begins with `path`, as whoever
/// runs the program knows the file, if it cannot be written.
void write_file(OutputFolder& folder, const std::string& name, const std::string& content,
                const std::filesystem::path& path);

}  // namespace prospect

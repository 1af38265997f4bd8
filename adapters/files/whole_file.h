#pragma once

#include <string>

namespace prospect {

/// Writes a file to `path`.part and renames it, so that `path` is whole or as it was before.
/// Returns
/// "" or why it could not be written, in words.
std::string write_whole_file(const std::string& path, const std::string& content);

}  // namespace prospect

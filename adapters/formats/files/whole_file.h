// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// What is added to a file's name until it is whole.
inline constexpr const char* kPart = ".part";

/// Writes a file to `path`.part and renames it, so that `path` is whole or as it was before. A
/// symbolic link is not followed: not written through at `path`.part, and replaced at `path`.
/// Returns "" or why it could not be written, in words.
std::string write_whole_file(const std::string& path, const std::string& content);

}  // namespace prospect

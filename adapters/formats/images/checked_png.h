// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace prospect {

/// The chunks of a PNG that say what its pixels are, each checked, as a PNG: the decoder would fill
/// what is missing with anything, and complains on standard error of what is damaged and of colour
/// profiles that do not matter here. `path` stands for the file in messages.
/// Throws InputError, one line: no PNG, truncated, a wrong checksum, an image without pixels or
/// with more than `most_pixels`.
std::string checked_png(const std::string& path, std::string_view bytes, std::int64_t most_pixels);

/// Unpacks the pixels of what checked_png() returned, and throws InputError, one line, unless they
/// are as many bytes as its header speaks of. The decoder would make them up, or complain on
/// standard error. Takes as long as decoding.
void check_png_pixels(const std::string& path, std::string_view bytes);

}  // namespace prospect

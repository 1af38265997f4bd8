// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace prospect {

/// What LZF (the format of Marc Lehmann's LibLZF, of which a PCD's binary_compressed data are one
/// block) made of `size` bytes. Empty if the block is no such one.
///
/// A block is a sequence of runs. 000LLLLL: L + 1 bytes follow as they are. LLLOOOOO OOOOOOOO: L +
/// 2 bytes again from O + 1 bytes before; with L = 7 a byte between the two is added to L.
std::string lzf_decompressed(std::string_view block, std::size_t size);

}  // namespace prospect

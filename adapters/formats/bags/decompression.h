// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace prospect {

/// The compressions of bags: of a whole file, of a chunk or of one message.
enum class Compression { kNone, kLz4, kZstd };

/// By the bytes that a frame of it begins with; kNone: neither.
Compression compression_of(std::string_view bytes);

/// The next piece of what is compressed; empty at the end. Valid until the next call.
using ByteSource = std::function<std::string_view()>;
/// Takes the next piece of what comes out.
using ByteSink = std::function<void(std::string_view)>;

/// Decompresses one frame or several in a row (kNone: copies), in pieces: memory does not grow with
/// their size. Throws InputError, `where: ...`, of damaged bytes and of those that end early;
/// NotBuiltIn where the library was absent when the program was built; what `source` and `sink`
/// throw.
void decompress(Compression compression, const ByteSource& source, const ByteSink& sink,
                const std::string& where);

/// Likewise, of bytes at hand; throws InputError where they become more than `most`.
std::string decompressed(Compression compression, std::string_view bytes, std::size_t most,
                         const std::string& where);

}  // namespace prospect

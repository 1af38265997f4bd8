// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/images/checked_png.h"

#include <zlib.h>

#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1u)));
    table[n] = crc;
  }
  return table;
}

/// CRC-32 of ISO 3309, as PNG uses it.
std::uint32_t crc32(std::string_view bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = crc_table();
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) crc = crc >> 8 ^ kTable[(crc ^ static_cast<unsigned char>(c)) & 0xffu];
  return ~crc;
}

}  // namespace

std::string checked_png(const std::string& path, std::string_view bytes, std::int64_t most_pixels) {
  if (!bytes.starts_with(kSignature)) fail(path, "not a PNG image; expected one");
  std::string kept(kSignature);
  for (std::size_t at = kSignature.size();;) {
    if (at + 12 > bytes.size()) fail(path, "truncated PNG; expected its last chunk (IEND)");
    const std::uint32_t length = big_endian(bytes, at);
    if (length > bytes.size() - at - 12) {
      fail(path, "truncated or corrupt PNG; expected " + std::to_string(length) +
                     " bytes in a chunk at byte " + std::to_string(at));
    }
    const std::string_view type = bytes.substr(at + 4, 4);
    if (crc32(bytes.substr(at + 4, 4 + static_cast<std::size_t>(length))) !=
        big_endian(bytes, at + 8 + length)) {
      fail(path, "corrupt PNG: wrong checksum of the chunk at byte " + std::to_string(at) +
                     "; expected an intact file");
    }
    if (at == kSignature.size()) {
      if (type != "IHDR" || length != 13) fail(path, "corrupt PNG; expected an IHDR chunk first");
      const std::int64_t width = big_endian(bytes, at + 8), height = big_endian(bytes, at + 12);
      if (width < 1 || height < 1 || width > most_pixels || height > most_pixels / width) {
        fail(path, "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels; expected at least 1 x 1 and at most " +
                       std::to_string(most_pixels) + " pixels");
      }
    }
    if (type == "IHDR" || type == "PLTE" || type == "IDAT" || type == "IEND" || type == "tRNS") {
      kept += bytes.substr(at, 12 + static_cast<std::size_t>(length));
    }
    if (type == "IEND") return kept;
    at += 12 + static_cast<std::size_t>(length);
  }
}

void check_png_pixels(const std::string& path, std::string_view bytes) {
  const std::size_t header = kSignature.size() + 8;
  const std::uint64_t width = big_endian(bytes, header), height = big_endian(bytes, header + 4);
  const int depth = static_cast<unsigned char>(bytes[header + 8]);
  const int colour = static_cast<unsigned char>(bytes[header + 9]);
  const bool interlaced = bytes[header + 12] != 0;
  const int channels = colour == 2 ? 3 : colour == 4 ? 2 : colour == 6 ? 4 : 1;
  const auto size = [&](std::uint64_t w, std::uint64_t h) -> std::uint64_t {
    if (w == 0 || h == 0) return 0;
    return h * (1 + (w * static_cast<std::uint64_t>(channels * depth) + 7) / 8);
  };
  std::uint64_t expected = 0;
  if (!interlaced) {
    expected = size(width, height);
  } else {
    struct Pass {  // of Adam7
      std::uint64_t x, y, dx, dy;
    };
    constexpr Pass kPasses[] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    for (const auto& [x, y, dx, dy] : kPasses) {
      expected += size(width > x ? (width - x + dx - 1) / dx : 0,
                       height > y ? (height - y + dy - 1) / dy : 0);
    }
  }
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, decltype(&inflateEnd)> ends(&stream, &inflateEnd);
  std::vector<unsigned char> buffer(std::size_t{1} << 16);
  std::uint64_t found = 0;
  int state = Z_OK;
  for (std::size_t at = kSignature.size();
       at + 12 <= bytes.size() && state == Z_OK && found <= expected;) {
    const std::size_t length = big_endian(bytes, at);
    if (bytes.substr(at + 4, 4) == "IDAT") {
      std::string piece(bytes.substr(at + 8, length));
      stream.next_in = reinterpret_cast<unsigned char*>(piece.data());
      stream.avail_in = static_cast<unsigned>(piece.size());
      do {
        stream.next_out = buffer.data();
        stream.avail_out = static_cast<unsigned>(buffer.size());
        state = inflate(&stream, Z_NO_FLUSH);
        found += buffer.size() - stream.avail_out;
      } while (state == Z_OK && found <= expected && stream.avail_out == 0);
      if (state == Z_BUF_ERROR) state = Z_OK;  // all of this chunk is read
    }
    at += 12 + length;
  }
  if (state != Z_STREAM_END || found != expected) {
    fail(path, std::to_string(found) + " bytes of pixels in the PNG; expected " +
                   std::to_string(expected) + " (truncated or corrupt)");
  }
}

}  // namespace prospect

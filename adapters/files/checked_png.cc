#include "adapters/files/checked_png.h"

#include <array>
#include <cstddef>

#include "adapters/files/input_error.h"

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

}  // namespace prospect

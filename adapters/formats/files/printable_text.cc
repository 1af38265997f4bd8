// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/printable_text.h"

namespace prospect {
namespace {

/// Bytes of the character that begins so; 0 for one that begins none.
std::size_t length_by(unsigned char byte) {
  if (byte < 0x80) return 1;
  if (byte < 0xC2 || byte > 0xF4) return 0;
  return byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
}

/// Of a whole character of two bytes or more.
bool is_harmless(std::string_view bytes) {
  constexpr unsigned char kPayload[] = {0, 0, 0x1F, 0x0F, 0x07};
  constexpr unsigned kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  unsigned code = static_cast<unsigned char>(bytes[0]) & kPayload[bytes.size()];
  for (const char c : bytes.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3FU);
  const auto between = [code](unsigned low, unsigned high) { return code >= low && code <= high; };
  const bool none = code < kLeast[bytes.size()] || code > 0x10FFFF || between(0xD800, 0xDFFF);
  const bool turns = code == 0x061C || between(0x200E, 0x200F) || between(0x2028, 0x202E) ||
                     between(0x2066, 0x2069);
  return !none && !turns && !between(0x80, 0x9F);
}

}  // namespace

std::string PrintableText::of(std::string_view piece) {
  std::string out;
  out.reserve(piece.size());
  for (const char c : piece) {
    const auto byte = static_cast<unsigned char>(c);
    if (!begun_.empty()) {
      if (byte >= 0x80 && byte < 0xC0) {
        begun_ += c;
        if (begun_.size() < awaited_) continue;
        out += is_harmless(begun_) ? begun_ : "?";
        begun_.clear();
        continue;
      }
      out += end();
    }
    awaited_ = length_by(byte);
    if (awaited_ > 1) {
      begun_ = c;
      continue;
    }
    const bool plain = (byte >= 0x20 && byte < 0x7F) || c == '\n' || c == '\t';
    out += plain ? c : '?';
  }
  return out;
}

std::string PrintableText::end() {
  const std::string out(begun_.size(), '?');
  begun_.clear();
  return out;
}

std::string printable(std::string_view text) {
  PrintableText pieces;
  const std::string out = pieces.of(text);
  return out + pieces.end();
}

}  // namespace prospect

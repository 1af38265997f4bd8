// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/page/binary_text.h"

#include <bit>

namespace prospect {

void BinaryText::add_varint(std::uint64_t value) {
  while (value >= 0x80) {
    bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
    value >>= 7;
  }
  bytes_.push_back(static_cast<std::uint8_t>(value));
}

void BinaryText::add_signed_varint(std::int64_t value) {
  add_varint(static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63));
}

void BinaryText::add_bytes(const std::vector<std::uint8_t>& bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void BinaryText::add_float(double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int shift = 0; shift < 32; shift += 8) {
    bytes_.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

std::string BinaryText::base64() const {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes_.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes_.size(); i += 3) {
    const std::size_t left = bytes_.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes_[i]) << 16 |
                                (left > 1 ? static_cast<std::uint32_t>(bytes_[i + 1]) << 8 : 0) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes_[i + 2]) : 0);
    text += kDigits[group >> 18];
    text += kDigits[group >> 12 & 63];
    text += left > 1 ? kDigits[group >> 6 & 63] : '=';
    text += left > 2 ? kDigits[group & 63] : '=';
  }
  return text;
}

}  // namespace prospect

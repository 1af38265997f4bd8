// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prospect {

/// Arrays of numbers as text that a web page decodes fast: bytes, then base64 (RFC 4648, padded).
class BinaryText {
 public:
  /// Unsigned, seven bits a byte, lowest first, the top bit set on all bytes but the last (LEB128):
  /// small numbers take one byte.
  void add_varint(std::uint64_t value);
  /// Signed: 0, -1, 1, -2, 2 ... as the unsigned 0, 1, 2, 3, 4 ... (zigzag).
  void add_signed_varint(std::int64_t value);
  void add_bytes(const std::vector<std::uint8_t>& bytes);
  /// IEEE 754 single precision, little-endian.
  void add_float(double value);

  std::string base64() const;

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace prospect

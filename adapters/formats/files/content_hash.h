// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace prospect {

/// A name for what bytes say: 64 bits, FNV-1a (Fowler, Noll, Vo) with the last bits mixed as in
/// SplitMix64. The same on every machine. Not against forgery: among a million contents a pair has
/// the same name with a chance of 3e-8. A value; not thread-safe.
class ContentHash {
 public:
  ContentHash& add(const void* bytes, std::size_t size);
  /// With its length, so that "ab", "c" is another content than "a", "bc".
  ContentHash& add(std::string_view text);
  ContentHash& add(std::uint64_t number);
  /// Of its bits.
  ContentHash& add(double number);

  std::uint64_t value() const;
  /// value() by hash_text().
  std::string text() const;

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ull;
};

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// Of what a file holds. Throws InputError if it cannot be read.
std::uint64_t file_hash(const std::string& path);

}  // namespace prospect

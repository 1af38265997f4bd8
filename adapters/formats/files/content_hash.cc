// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/content_hash.h"

#include <array>
#include <bit>
#include <cstdio>
#include <fstream>

#include "adapters/formats/files/input_error.h"

namespace prospect {

ContentHash& ContentHash::add(const void* bytes, std::size_t size) {
  constexpr std::uint64_t kPrime = 0x100000001b3ull;
  const auto* at = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ at[i]) * kPrime;
  return *this;
}

ContentHash& ContentHash::add(std::string_view text) {
  return add(static_cast<std::uint64_t>(text.size())).add(text.data(), text.size());
}

ContentHash& ContentHash::add(std::uint64_t number) {
  unsigned char bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<unsigned char>(number >> (8 * i));
  return add(bytes, sizeof bytes);
}

ContentHash& ContentHash::add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }

std::uint64_t ContentHash::value() const {
  std::uint64_t x = state_;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

std::string ContentHash::text() const { return hash_text(value()); }

std::string hash_text(std::uint64_t hash) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

std::uint64_t file_hash(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  ContentHash hash;
  std::array<char, 65536> buffer;
  while (in) {
    in.read(buffer.data(), buffer.size());
    hash.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) fail(path, "cannot be read; expected a readable file");
  return hash.value();
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/lzf.h"

namespace prospect {

std::string lzf_decompressed(std::string_view block, std::size_t size) {
  std::string bytes;
  std::size_t at = 0;
  const auto next = [&] {
    return static_cast<std::size_t>(static_cast<unsigned char>(block[at++]));
  };
  constexpr std::size_t kMostInARun = 264;
  if (block.empty() || size / block.size() > kMostInARun) return {};  // before any memory is taken
  bytes.reserve(size);
  while (at < block.size()) {
    const std::size_t control = next();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > block.size() - at || length > size - bytes.size()) return {};
      bytes.append(block.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (at == block.size()) return {};
      length += next();
    }
    length += 2;
    if (at == block.size()) return {};
    const std::size_t back = ((control & 31) << 8 | next()) + 1;
    if (back > bytes.size() || length > size - bytes.size()) return {};
    // One by one: what is repeated may reach into what comes of it.
    for (std::size_t n = 0; n < length; ++n) bytes.push_back(bytes[bytes.size() - back]);
  }
  return bytes.size() == size ? bytes : std::string();
}

}  // namespace prospect

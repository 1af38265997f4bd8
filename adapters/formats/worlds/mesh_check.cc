// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_check.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/left_out.h"
#include "adapters/formats/worlds/ply_header.h"

namespace prospect {
namespace {

/// Lines whose first word begins with `word`.
std::size_t lines_with(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    at = text.find_first_not_of(" \t\r\n", at);
    if (at == std::string_view::npos) break;
    if (text.substr(at, word.size()) == word) ++count;
    at = text.find_first_of("\r\n", at);
  }
  return count;
}

/// Lines that are not empty, but no more than `enough` of them.
std::uint64_t lines_in(std::string_view text, std::uint64_t enough) {
  std::uint64_t count = 0;
  bool begun = false;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      begun = false;
    } else if (!begun && std::isspace(static_cast<unsigned char>(c)) == 0) {
      begun = true;
      if (++count >= enough) break;
    }
  }
  return count;
}

/// The element within which binary data end too early; none if they are whole.
std::optional<std::string> torn_element(const PlyHeader& header, std::string_view data,
                                        bool big_endian) {
  std::size_t at = 0;
  const auto take = [&](std::uint64_t size) {
    if (size > data.size() - at) return false;
    at += static_cast<std::size_t>(size);
    return true;
  };
  for (const PlyElement& element : header.elements) {
    std::uint64_t plain = 0;
    bool lists = false;
    for (const PlyProperty& property : element.properties) {
      lists = lists || property.length_size > 0;
      plain += property.size;
    }
    if (!lists) {
      if (plain > 0 && element.count > data.size() / plain) return element.name;
      if (!take(plain * element.count)) return element.name;
      continue;
    }
    for (std::uint64_t n = 0; n < element.count; ++n) {
      for (const PlyProperty& property : element.properties) {
        std::uint64_t length = 1;
        if (property.length_size > 0) {
          const std::size_t begin = at;
          if (!take(property.length_size)) return element.name;
          length = 0;
          for (std::size_t k = 0; k < property.length_size; ++k) {
            const std::size_t place = big_endian ? k : property.length_size - 1 - k;
            length = length << 8 | static_cast<unsigned char>(data[begin + place]);
          }
          const bool negative =
              property.length_signed && (length >> (8 * property.length_size - 1) & 1U) != 0;
          if (negative) return element.name;
        }
        if (!take(length * property.size)) return element.name;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

void check_stl(std::string_view bytes, const std::string& source) {
  constexpr std::size_t kHead = 84, kFacet = 50;  // [bytes]
  std::uint32_t facets = 0;
  if (bytes.size() >= kHead) {
    std::memcpy(&facets, bytes.data() + kHead - 4, sizeof facets);
    static_assert(std::endian::native == std::endian::little);
    if (bytes.size() == kHead + kFacet * std::size_t{facets}) return;
  }
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text = bytes.substr(std::min(first, bytes.size()));
  if (text.starts_with("solid") && bytes.find('\0') == std::string_view::npos) {
    const std::size_t begun = lines_with(text, "facet"), ended = lines_with(text, "endfacet");
    if (begun != ended || lines_with(text, "endsolid") == 0) {
      fail(source, std::to_string(begun) + " facets begin and " + std::to_string(ended) +
                       " end; expected a whole STL, with endsolid (truncated or corrupt)");
    }
    return;
  }
  if (text.starts_with("SOLID") && text.find("FACET") != std::string_view::npos) {
    fail(source, "an ASCII STL in capitals; expected its words in small letters, as 'solid'");
  }
  if (bytes.size() < kHead) {
    fail(source, std::to_string(bytes.size()) +
                     " bytes; expected an STL, ASCII ('solid') or "
                     "binary (84 bytes and 50 a triangle)");
  }
  fail(source, std::to_string(bytes.size()) + " bytes; expected " +
                   std::to_string(kHead + kFacet * std::size_t{facets}) + " for the " +
                   std::to_string(facets) +
                   " triangles that a binary STL says here, or an ASCII one ('solid')");
}

void check_ply(std::string_view bytes, const std::string& source) {
  const PlyHeader header = ply_header(bytes, source);
  if (!header.has_surfaces()) fail(source, "only points (no element face); expected surfaces");
  const std::string_view data = bytes.substr(header.end);
  if (header.format == "ascii") {
    std::uint64_t lines = 0;
    for (const PlyElement& element : header.elements) {
      lines += std::min<std::uint64_t>(element.count, std::uint64_t{1} << 40);
    }
    const std::uint64_t found = lines_in(data, lines);
    if (found < lines) {
      fail(source, std::to_string(found) + " lines after the header; expected " +
                       std::to_string(lines) + ", one an element (truncated)");
    }
    return;
  }
  const std::optional<std::string> torn =
      torn_element(header, data, header.format == "binary_big_endian");
  if (torn)
    fail(source, "ends within its " + in_quotes(*torn) +
                     " elements; expected as many as "
                     "its header says (truncated or corrupt)");
}

void check_collada(std::string_view bytes, const std::string& source) {
  constexpr std::string_view kUnit = "<unit", kMeter = "meter";
  for (std::size_t at = bytes.find(kUnit); at != std::string_view::npos;
       at = bytes.find(kUnit, at + 1)) {
    const std::string_view tag =
        bytes.substr(at, std::min(bytes.find('>', at) - at, std::size_t{1000}));
    for (std::size_t key = tag.find(kMeter); key != std::string_view::npos;
         key = tag.find(kMeter, key + 1)) {
      std::size_t begin = key + kMeter.size();
      const auto skip = [&] {
        while (begin < tag.size() && std::isspace(static_cast<unsigned char>(tag[begin])) != 0) {
          ++begin;
        }
      };
      skip();
      if (begin >= tag.size() || tag[begin] != '=') continue;  // a part of another word
      ++begin;
      skip();
      if (begin >= tag.size() || (tag[begin] != '"' && tag[begin] != '\'')) continue;
      const std::size_t end = tag.find(tag[begin], begin + 1);
      std::string text(
          tag.substr(begin + 1, end == std::string_view::npos ? end : end - begin - 1));
      const std::string said = text;
      std::replace(text.begin(), text.end(), ',', '.');
      double value = 0.0;
      const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
      if (parsed.ec != std::errc() || !std::isfinite(value) || value <= 0.0) {
        fail(source, "a unit of " + in_quotes(said) + " m; expected a positive length");
      }
    }
  }
}

}  // namespace prospect

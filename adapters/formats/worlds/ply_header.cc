// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/ply_header.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/left_out.h"

namespace prospect {
namespace {

constexpr std::size_t kLongestHeader = 1 << 20;  // [bytes]

std::size_t ply_size(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes = {
      {"char", 1},   {"int8", 1},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
      {"ushort", 2}, {"uint16", 2},  {"int", 4},    {"int32", 4},  {"uint", 4},  {"uint32", 4},
      {"float", 4},  {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

bool is_float(const std::string& type) { return type[0] == 'f' || type[0] == 'd'; }

bool is_signed(const std::string& type) {
  return type == "char" || type == "int8" || type == "short" || type == "int16" || type == "int" ||
         type == "int32";
}

}  // namespace

bool PlyHeader::has_surfaces() const {
  return std::any_of(elements.begin(), elements.end(), [](const PlyElement& e) {
    const bool surfaces = e.name == "face" || e.name == "faces" || e.name == "tristrips" ||
                          e.name == "triangle_strips";
    return surfaces && e.count > 0;
  });
}

PlyHeader ply_header(std::string_view bytes, const std::string& source) {
  PlyHeader header;
  std::size_t at = 0;
  for (int number = 1;; ++number) {
    const std::size_t end = bytes.substr(0, kLongestHeader).find('\n', at);
    if (end == std::string_view::npos) fail(source, "the header does not end; expected end_header");
    std::string text(bytes.substr(at, end - at));
    if (!text.empty() && text.back() == '\r') text.pop_back();
    at = end + 1;
    std::istringstream line(text);
    std::string word, type;
    line >> word;
    if (number == 1) {
      if (word != "ply") fail(source, "no PLY; expected 'ply' in the first line");
      continue;
    }
    if (word == "end_header") break;
    const auto wrong = [&] {
      fail(source + ":" + std::to_string(number),
           "the line " + in_quotes(text) + "; expected a header of PLY");
    };
    if (word == "format") {
      line >> header.format;
    } else if (word == "element") {
      PlyElement element;
      line >> element.name >> word;
      const auto parsed = std::from_chars(word.data(), word.data() + word.size(), element.count);
      if (!line || parsed.ec != std::errc() || parsed.ptr != word.data() + word.size()) wrong();
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty() || !(line >> type)) wrong();
      PlyProperty property;
      if (type == "list") {
        std::string length;
        if (!(line >> length >> type)) wrong();
        property.length_size = ply_size(length);
        property.length_signed = is_signed(length);
        if (property.length_size == 0 || is_float(length)) wrong();
      }
      property.size = ply_size(type);
      property.is_float = is_float(type);
      property.is_signed = is_signed(type);
      if (property.size == 0 || !(line >> property.name)) wrong();
      header.elements.back().properties.push_back(property);
    }
  }
  if (header.format != "ascii" && header.format != "binary_little_endian" &&
      header.format != "binary_big_endian") {
    fail(source, "the format " + in_quotes(header.format) +
                     "; expected ascii, binary_little_endian or binary_big_endian");
  }
  header.end = at;
  return header;
}

PlyHeader read_ply_header(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(kLongestHeader, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return ply_header(bytes, path);
}

}  // namespace prospect

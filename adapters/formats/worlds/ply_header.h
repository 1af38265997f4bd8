// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// A property of a PLY's element: a number of that many bytes, or a list of such numbers after its
/// length.
struct PlyProperty {
  std::string name;
  std::size_t size = 0;
  bool is_float = false, is_signed = false;
  std::size_t length_size = 0;  ///< of a list
  bool length_signed = false;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// What a PLY says that it holds.
struct PlyHeader {
  std::string format;  ///< one of ascii, binary_little_endian, binary_big_endian
  std::vector<PlyElement> elements;
  std::size_t end = 0;  ///< where the data begin

  /// Whether it has elements besides vertices: faces, strips, edges.
  bool has_surfaces() const;
};

/// Of a file's bytes, at least those of the header. Throws InputError, one line that begins with
/// `source`.
PlyHeader ply_header(std::string_view bytes, const std::string& source);

/// Of a header in the first megabyte of a file.
PlyHeader read_ply_header(const std::string& path);

}  // namespace prospect

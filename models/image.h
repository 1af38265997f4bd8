// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace prospect {

/// An 8-bit grey image that belongs to someone else. Pixel (u, v): column u to the right, row v
/// down; the centre of the first pixel is (0, 0). Valid while the owner keeps it.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;              ///< [px]
  int height = 0;             ///< [px]
  std::ptrdiff_t stride = 0;  ///< bytes from one row to the next, >= width

  const std::uint8_t* row(int v) const { return data + v * stride; }
  bool empty() const { return data == nullptr || width <= 0 || height <= 0; }
};

/// An 8-bit grey image as a value, rows without gaps.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  Image() = default;
  Image(int w, int h, std::uint8_t grey = 0)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * h, grey) {}
  std::uint8_t& at(int u, int v) { return pixels[static_cast<std::size_t>(v) * width + u]; }
  std::uint8_t at(int u, int v) const { return pixels[static_cast<std::size_t>(v) * width + u]; }
  ImageView view() const { return {pixels.data(), width, height, width}; }
};

/// The two images of a stereo pair.
struct ImagePair {
  Image left, right;
};

}  // namespace prospect

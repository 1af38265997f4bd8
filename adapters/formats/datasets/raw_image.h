// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/image.h"

namespace prospect {

/// An image as a recording holds it: rows without gaps, channels interleaved (blue, green, red and
/// perhaps opacity), numbers in the machine's own byte order.
struct RawImage {
  enum class Kind { k8, k16, kFloat };
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int channels = 1;
  Kind kind = Kind::k8;
  std::vector<std::uint8_t> bytes;

  int bytes_per_number() const { return kind == Kind::k8 ? 1 : kind == Kind::k16 ? 2 : 4; }
  std::uint16_t number16(std::size_t i) const;
  float number_float(std::size_t i) const;
};

/// Whether a file of this name is an image that can be read: PNG, JPEG, TIFF, BMP, PGM, PPM, PFM,
/// by its ending in any case. Hidden files are none: every archive from a Mac is full of them.
bool is_image_name(const std::string& name);

/// The pixels of an encoded image, as they are: no colour profile. `name` stands for it in
/// messages. Throws InputError, one line: not an image, truncated, damaged, more than 100 million
/// pixels, numbers that are neither of 8 or 16 bits nor 32-bit floats, or an orientation (Exif,
/// TIFF) by which pixels are to be turned.
RawImage decode_image(std::string_view bytes, const std::string& name);
/// Likewise, of a file.
RawImage read_image_file(const std::string& path);

/// The least of 8, 10, 12, 14 and 16 bits that hold every number of the image: what its sensor
/// measures. 8 for images of bytes.
int significant_bits(const RawImage& image);

/// As 8-bit grey: of numbers of 16 bits the upper 8 of `bits`, what is larger is white; colours by
/// their luminance. Throws InputError for floats; `name` stands for the image.
Image grey_image(const RawImage& image, int bits, const std::string& name);

}  // namespace prospect

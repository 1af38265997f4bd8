// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/raw_image.h"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/checked_png.h"
#include "adapters/formats/images/image_codec.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

constexpr std::int64_t kMostImagePixels = 100'000'000;

[[noreturn]] void undecodable(const std::string& name) {
  throw InputError(name + ": cannot be decoded; expected an image");
}

/// The decoder fills what is missing with grey: so first whether all is there.
void check_jpeg(const std::string& name, std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  std::size_t at = 2;
  std::int64_t pixels = 0;
  while (true) {
    while (at + 1 < bytes.size() && byte(at) == 0xff && byte(at + 1) == 0xff) ++at;
    if (at + 4 > bytes.size()) throw InputError(name + ": truncated JPEG; expected all of it");
    const int marker = byte(at + 1);
    if (byte(at) != 0xff) throw InputError(name + ": damaged JPEG; expected an intact file");
    if (marker == 0xda) break;
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame && at + 9 < bytes.size()) {
      pixels = std::int64_t{byte(at + 5) * 256 + byte(at + 6)} *
               std::int64_t{byte(at + 7) * 256 + byte(at + 8)};
    }
    at += 2 + static_cast<std::size_t>(byte(at + 2) * 256 + byte(at + 3));
  }
  if (pixels < 1 || pixels > kMostImagePixels) {
    throw InputError(name + ": a JPEG of " + std::to_string(pixels) +
                     " pixels; expected 1 to 100000000");
  }
  const std::size_t end = bytes.rfind("\xff\xd9");
  if (end == std::string_view::npos || end < at) {
    throw InputError(name + ": truncated JPEG; expected its end marker");
  }
}

/// Numbers of a TIFF file or block, in its byte order.
class TiffBytes {
 public:
  explicit TiffBytes(std::string_view bytes) : bytes_(bytes), little_(bytes.starts_with("II")) {}
  std::uint32_t number(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t byte = at + (little_ ? size - 1 - i : i);
      value = value << 8 | static_cast<unsigned char>(bytes_[byte]);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool little_;
};

/// The entry Orientation of the first directory of a TIFF file or an Exif block; 1 (as the pixels
/// lie) if there is none.
int tiff_orientation(std::string_view bytes) {
  constexpr std::uint32_t kOrientation = 0x0112;
  if (!bytes.starts_with("II") && !bytes.starts_with("MM")) return 1;
  const TiffBytes tiff(bytes);
  const std::size_t directory = tiff.number(4, 4);
  const std::uint32_t entries = tiff.number(directory, 2);
  for (std::uint32_t n = 0; n < entries; ++n) {
    const std::size_t entry = directory + 2 + std::size_t{12} * n;
    if (tiff.number(entry, 2) == kOrientation) return static_cast<int>(tiff.number(entry + 8, 2));
  }
  return 1;
}

/// The Exif block of a JPEG or PNG, a TIFF file itself; empty if there is none.
std::string_view exif_of(std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  if (bytes.starts_with("II") || bytes.starts_with("MM")) return bytes;
  if (bytes.starts_with("\x89PNG")) {
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
      std::size_t length = 0;
      for (std::size_t i = 0; i < 4; ++i) length = length << 8 | byte(at + i);
      if (length > bytes.size() - at - 12) return {};
      if (bytes.substr(at + 4, 4) == "eXIf") return bytes.substr(at + 8, length);
      at += 12 + length;
    }
    return {};
  }
  if (!bytes.starts_with("\xff\xd8")) return {};
  for (std::size_t at = 2; at + 10 <= bytes.size() && byte(at) == 0xff && byte(at + 1) != 0xda;) {
    const std::size_t length = byte(at + 2) * std::size_t{256} + byte(at + 3);
    if (byte(at + 1) == 0xe1 && bytes.substr(at + 4, 6) == std::string_view("Exif\0\0", 6)) {
      return bytes.substr(at + 10, length - std::min<std::size_t>(length, 8));
    }
    at += 2 + length;
  }
  return {};
}

RawImage raw_image(const cv::Mat& image, const std::string& name) {
  RawImage raw;
  raw.width = image.cols;
  raw.height = image.rows;
  raw.channels = image.channels();
  switch (image.depth()) {
    case CV_8U:
      raw.kind = RawImage::Kind::k8;
      break;
    case CV_16U:
      raw.kind = RawImage::Kind::k16;
      break;
    case CV_32F:
      raw.kind = RawImage::Kind::kFloat;
      break;
    default:
      throw InputError(name +
                       ": pixels of an unusual kind; expected 8 or 16 bits, or 32-bit floats");
  }
  const std::size_t row = image.elemSize() * static_cast<std::size_t>(image.cols);
  raw.bytes.resize(row * static_cast<std::size_t>(image.rows));
  for (int v = 0; v < image.rows; ++v) {
    std::copy_n(image.ptr<std::uint8_t>(v), row,
                raw.bytes.data() + static_cast<std::size_t>(v) * row);
  }
  return raw;
}

}  // namespace

std::uint16_t RawImage::number16(std::size_t i) const {
  std::uint16_t value;
  std::memcpy(&value, bytes.data() + 2 * i, 2);
  return value;
}

float RawImage::number_float(std::size_t i) const {
  float value;
  std::memcpy(&value, bytes.data() + 4 * i, 4);
  return value;
}

bool is_image_name(const std::string& name) {
  if (name.empty() || name[0] == '.') return false;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string ending = lower_case(name.substr(dot + 1));
  static const char* const kEndings[] = {"png", "jpg", "jpeg", "tif", "tiff",
                                         "bmp", "pgm", "ppm",  "pfm"};
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

RawImage decode_image(std::string_view bytes, const std::string& name) {
  // Programs differ in whether they turn the pixels: a calibration is of one of the two.
  const int orientation = tiff_orientation(exif_of(bytes));
  if (orientation != 1 && orientation != 0) {
    throw InputError(name + ": its orientation (Exif) is " + std::to_string(orientation) +
                     ", so pixels are to be turned or mirrored; expected 1: `exiftran -a` or "
                     "`mogrify -auto-orient` turns them, deleting the entry leaves them");
  }
  std::string checked;
  if (bytes.starts_with("\x89PNG")) {
    checked = checked_png(name, bytes, kMostImagePixels);
  } else {
    if (bytes.starts_with("\xff\xd8")) check_jpeg(name, bytes);
    checked = bytes;
  }
  if (checked.empty()) undecodable(name);
  cv::Mat image;
  try {
    image = decode_pixels(cv::Mat(1, static_cast<int>(checked.size()), CV_8UC1, checked.data()),
                          cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) undecodable(name);
  return raw_image(image, name);
}

RawImage read_image_file(const std::string& path) {
  return decode_image(read_whole_file(path), path);
}

int significant_bits(const RawImage& image) {
  if (image.kind != RawImage::Kind::k16) return 8;
  int largest = 0;
  for (std::size_t i = 0; i < image.bytes.size() / 2; ++i) {
    largest = std::max<int>(largest, image.number16(i));
  }
  for (const int bits : {8, 10, 12, 14}) {
    if (largest < 1 << bits) return bits;
  }
  return 16;
}

Image grey_image(const RawImage& image, int bits, const std::string& name) {
  if (image.kind == RawImage::Kind::kFloat) {
    throw InputError(name + ": an image of floats; expected grey or colour of 8 or 16 bits");
  }
  const bool wide = image.kind == RawImage::Kind::k16;
  const cv::Mat all(image.height, image.width, CV_MAKETYPE(wide ? CV_16U : CV_8U, image.channels),
                    const_cast<std::uint8_t*>(image.bytes.data()));
  cv::Mat grey = all;
  if (image.channels == 3) {
    cv::cvtColor(all, grey, cv::COLOR_BGR2GRAY);
  } else if (image.channels == 4) {
    cv::cvtColor(all, grey, cv::COLOR_BGRA2GRAY);
  } else if (image.channels != 1) {
    throw InputError(name + ": has " + std::to_string(image.channels) +
                     " channels; expected grey or colour");
  }
  Image out(image.width, image.height);
  for (int v = 0; v < image.height; ++v) {
    std::uint8_t* to = out.pixels.data() + static_cast<std::size_t>(v) * out.width;
    if (!wide) {
      std::copy_n(grey.ptr<std::uint8_t>(v), image.width, to);
      continue;
    }
    const std::uint16_t* from = grey.ptr<std::uint16_t>(v);
    for (int u = 0; u < image.width; ++u) {
      to[u] = static_cast<std::uint8_t>(std::min(255, from[u] >> (bits - 8)));
    }
  }
  return out;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/images/plain_png.h"

#include <zlib.h>

#include <initializer_list>
#include <opencv2/core.hpp>
#include <string_view>

namespace prospect {
namespace {

using Bytes = std::vector<std::uint8_t>;

void add_number(Bytes& to, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// Length, name and data, with their checksum behind.
void add_chunk(Bytes& to, std::string_view name, const Bytes& data) {
  add_number(to, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = to.size();
  to.insert(to.end(), name.begin(), name.end());
  to.insert(to.end(), data.begin(), data.end());
  add_number(to, static_cast<std::uint32_t>(
                     ::crc32(0, to.data() + begin, static_cast<uInt>(to.size() - begin))));
}

/// Each row behind its filter, 0; numbers with the high byte first, colours as RGB.
Bytes rows_of(const cv::Mat& pixels) {
  Bytes rows;
  for (int v = 0; v < pixels.rows; ++v) {
    rows.push_back(0);
    const std::uint8_t* row = pixels.ptr<std::uint8_t>(v);
    const int channels = pixels.channels();
    for (int u = 0; u < pixels.cols; ++u) {
      if (pixels.depth() == CV_16U) {
        const std::uint16_t value = pixels.at<std::uint16_t>(v, u);
        rows.push_back(static_cast<std::uint8_t>(value >> 8));
        rows.push_back(static_cast<std::uint8_t>(value));
        continue;
      }
      const std::uint8_t* pixel = row + static_cast<std::ptrdiff_t>(u) * channels;
      if (channels == 1) {
        rows.push_back(pixel[0]);
      } else {
        rows.insert(rows.end(), {pixel[2], pixel[1], pixel[0]});
        if (channels == 4) rows.push_back(pixel[3]);
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<std::uint8_t> plain_png(const cv::Mat& pixels) {
  const int type = pixels.type();
  const bool known = type == CV_8UC1 || type == CV_16UC1 || type == CV_8UC3 || type == CV_8UC4;
  if (!known || pixels.empty()) return {};
  const Bytes rows = rows_of(pixels);
  uLongf length = compressBound(static_cast<uLong>(rows.size()));
  Bytes packed(length);
  if (compress2(packed.data(), &length, rows.data(), static_cast<uLong>(rows.size()), 9) != Z_OK) {
    return {};
  }
  packed.resize(length);

  Bytes header;
  add_number(header, static_cast<std::uint32_t>(pixels.cols));
  add_number(header, static_cast<std::uint32_t>(pixels.rows));
  const std::uint8_t colour = pixels.channels() == 1 ? 0 : pixels.channels() == 3 ? 2 : 6;
  header.insert(header.end(),
                {static_cast<std::uint8_t>(type == CV_16UC1 ? 16 : 8), colour, 0, 0, 0});
  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  add_chunk(png, "IHDR", header);
  add_chunk(png, "IDAT", packed);
  add_chunk(png, "IEND", {});
  return png;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prospect::test {

/// A video of a test, in the container Matroska, without an encoder: frames are given as bytes.
struct MatroskaVideo {
  struct Frame {
    std::uint64_t ms = 0;  ///< its time of presentation
    std::string bytes;
  };
  int width = 0, height = 0;
  std::vector<Frame> frames;
  std::string codec = "V_UNCOMPRESSED";  ///< or V_MJPEG: frames are JPEG images
  std::string pixels = "Y800";           ///< of uncompressed frames: grey, a byte a pixel

  std::string bytes() const {
    std::string clusters;
    for (const Frame& frame : frames) {
      const std::string block = std::string("\x81\0\0\x80", 4) + frame.bytes;
      clusters += element("\x1f\x43\xb6\x75", number("\xe7", frame.ms) + element("\xa3", block));
    }
    const std::string video =
        element("\xe0", number("\xb0", static_cast<std::uint64_t>(width)) +
                            number("\xba", static_cast<std::uint64_t>(height)) +
                            element("\x2e\xb5\x24", pixels));
    const std::string track = number("\xd7", 1) + number("\x73\xc5", 1) + number("\x83", 1) +
                              number("\x9c", 0) + element("\x86", codec) + video;
    return element("\x1a\x45\xdf\xa3", element("\x42\x82", "matroska") + number("\x42\x87", 2) +
                                           number("\x42\x85", 2)) +
           element("\x18\x53\x80\x67",
                   element("\x15\x49\xa9\x66", number("\x2a\xd7\xb1", 1'000'000)) +
                       element("\x16\x54\xae\x6b", element("\xae", track)) + clusters);
  }

 private:
  static std::string big_endian(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
  }
  static std::string element(const std::string& id, const std::string& content) {
    return id + "\x01" + big_endian(content.size(), 7) + content;
  }
  static std::string number(const std::string& id, std::uint64_t value) {
    return element(id, big_endian(value, 8));
  }
};

}  // namespace prospect::test

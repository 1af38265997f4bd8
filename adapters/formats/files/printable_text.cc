#include "adapters/formats/files/printable_text.h"

namespace prospect {

std::string PrintableText::of(std::string_view piece) {
  std::string out;
  out.reserve(piece.size());
  for (const char c : piece) {
    const auto byte = static_cast<unsigned char>(c);
    const bool within = byte >= 0x80 && byte < 0xC0;
    if (held_) {
      held_ = false;
      if (within) {
        // Of C1 it is one character that is replaced.
        out += byte < 0xA0 ? std::string("?") : std::string{'\xC2', c};
        continue;
      }
      out += '?';
    }
    if (within && follow_ > 0) {
      --follow_;
      out += c;
      continue;
    }
    follow_ = 0;
    if (byte == 0xC2) {
      held_ = true;
    } else if (byte > 0xC2 && byte < 0xF5) {
      follow_ = byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
      out += c;
    } else {
      const bool plain = (byte >= 0x20 && byte < 0x7F) || c == '\n' || c == '\t';
      out += plain ? c : '?';
    }
  }
  return out;
}

std::string printable(std::string_view text) { return PrintableText().of(text); }

}  // namespace prospect

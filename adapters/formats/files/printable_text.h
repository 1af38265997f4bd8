#pragma once

#include <string>
#include <string_view>

namespace prospect {

/// Makes text harmless for a terminal, piece by piece: control characters (C0, DEL, and C1, which
/// UTF-8 writes as C2 80 to C2 9F) and bytes that begin no character of UTF-8 become '?'; line
/// feeds and tabs stay. A file's name may hold escape sequences that erase, rewrite or answer.
class PrintableText {
 public:
  /// A piece as it may be printed. A character that a piece breaks off follows with the next.
  std::string of(std::string_view piece);

 private:
  bool held_ = false;  ///< a byte C2, whose character is not known yet
  int follow_ = 0;     ///< bytes that still belong to a character
};

/// A whole text.
std::string printable(std::string_view text);

}  // namespace prospect

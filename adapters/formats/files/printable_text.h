// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace prospect {

/// Makes text harmless for a terminal, piece by piece. '?' stands for
///   - control characters (C0, DEL and C1), but for line feeds and tabs;
///   - characters that change the direction or the lines of what is beside them (U+200E, U+200F,
///     U+061C, U+2028 to U+202E, U+2066 to U+2069): a name would read as another;
///   - bytes that are no UTF-8, also where a character is written longer than it is.
/// A file's name may hold escape sequences that erase, rewrite or answer.
class PrintableText {
 public:
  /// A piece as it may be printed. A character that a piece breaks off follows with the next.
  std::string of(std::string_view piece);
  /// What stands for a character that no piece ended: '?' or nothing.
  std::string end();

 private:
  std::string begun_;        ///< bytes of a character that is not whole yet
  std::size_t awaited_ = 0;  ///< as many bytes has it
};

/// A whole text.
std::string printable(std::string_view text);

}  // namespace prospect

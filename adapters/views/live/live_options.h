// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace prospect {

/// Where the live view is served, and to whom.
struct LiveOptions {
  int port = 0;                    ///< 0: a free one
  std::string host = "127.0.0.1";  ///< address of the interface; "0.0.0.0", "::": all
  /// What allows commands: letters, digits, "-" and "_", 16 to 128. Empty: made at random.
  std::string token{};
  std::size_t viewers = 16;  ///< without the token, at a time; further ones are turned away
  /// Who may command, at a time, beside those: a further one takes the place of the oldest.
  std::size_t commanders = 8;
  double idle_timeout = 30.0;     ///< [s] without an answer after which a viewer is given up
  double request_timeout = 10.0;  ///< [s] that a request may take to come, or a page to be read
  std::size_t longest_message = std::size_t{64} << 10;  ///< [bytes] from a viewer
};

}  // namespace prospect

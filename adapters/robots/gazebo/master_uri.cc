// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/master_uri.h"

#include <cstddef>
#include <string_view>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {

GazeboAddress with_master_uri(GazeboAddress address, const std::string& uri) {
  static constexpr std::string_view kScheme = "http://";
  std::string_view rest = uri;
  if (rest.ends_with('/')) rest.remove_suffix(1);
  const bool http = rest.starts_with(kScheme);
  if (http) rest.remove_prefix(kScheme.size());
  const std::size_t colon = rest.find(':');
  if (!http || colon == 0 || colon == std::string_view::npos ||
      !parse_number(rest.substr(colon + 1), address.port) || address.port < 1 ||
      address.port > 65535) {
    fail("GAZEBO_MASTER_URI", "'" + uri + "'; expected http://ADDRESS:PORT");
  }
  address.host = rest.substr(0, colon);
  return address;
}

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/robots/gazebo/gazebo_node.h"

namespace prospect {

/// Host and port of `uri`, "http://HOST:PORT", as in $GAZEBO_MASTER_URI; the rest is that of
/// `address`. Throws InputError if it is none.
GazeboAddress with_master_uri(GazeboAddress address, const std::string& uri);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/run_record.h"

namespace prospect {

/// A record without steps: what the report needs of the configuration.
RunRecord configured_record(const Configuration& configuration);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/formats/files/strict_yaml.h"

namespace prospect {

/// Keys of a configuration that once had another name, with all below them: one row a name that is
/// still read (StrictYaml::rename()). Of two rows for one key the first counts.
const std::vector<RenamedKey>& renamed_keys();

/// Keys that have no successor of the same meaning.
const std::vector<GoneKey>& gone_keys();

}  // namespace prospect

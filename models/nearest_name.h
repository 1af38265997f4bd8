// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace prospect {

/// The candidate with the smallest edit distance (insertion, deletion, substitution, swap of
/// neighbours; case ignored) to `name`, or "" if none is nearer than a third of the longer name's
/// length (at least one edit is allowed). Ties go to the earlier candidate.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// " (did you mean 'x'?)" for the nearest candidate, or "" if none is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates);

/// "; expected one of: a, b, c".
std::string expected_one_of(const std::vector<std::string>& candidates);

}  // namespace prospect

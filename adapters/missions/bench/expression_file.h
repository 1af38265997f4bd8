// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/bench/problem_set.h"

namespace prospect {

/// A file (JSON) of nonlinear programmes stated as expressions (problems/expression.h):
///
///   {"problems": [{"name": "HS15", "n": 2, "x0": [-2, 1], "objective": "100*(x2-x1^2)^2+(1-x1)^2",
///                  "inequalities_nonneg": ["x1*x2-1", "x1+x2^2"], "equalities_zero": [],
///                  "lower": [null, null], "upper": [0.5, null], "f_opt": 306.5}, ...]}
///
/// f_opt is the known optimum; it may be absent or null where nobody knows it. Other entries are
/// notes; lists are none. What a Problem has not is put in other words: stated_problem.h.
/// Throws InputError in one line that names the file, the problem and the entry.
ProblemSet read_expression_file(const std::string& path);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/formats/problem_file/archive.h"
#include "adapters/formats/problem_file/problem_file.h"

namespace prospect {

/// What a problem file looks like: hands every entry of the problem to the archive, to be written
/// or to be read. The one place that knows the format; docs/reference/problem_files.md describes
/// it. Throws std::invalid_argument, "/group/entry: what; expected what".
///
/// terms: where those that are not built in are looked up when reading.
///
/// What is read is sound in type, shape, range and size, but need not make a problem yet:
/// make_problem() says.
void transfer_problem(Archive& archive, SavedProblem& problem, const TermRegistry& terms);

}  // namespace prospect

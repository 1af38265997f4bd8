// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "problems/stated_programme.h"

namespace prospect {

/// Reads a file .nl of AMPL in its text form ("g"): one smooth nonlinear programme. Its name is
/// that of the file. A sum that is to be maximised is negated. Bounds of 1e20 and beyond are none.
///
/// Throws InputError in one line, "FILE:LINE: what; expected what", for a binary file, for what is
/// no smooth function of continuous variables (integer variables, logical constraints,
/// complementarity, imported functions, floor, piecewise linear terms), for several objectives, for
/// more than 1000 variables or 10000 constraints, and for a damaged file.
/// Source: D. M. Gay, "Writing .nl Files" (2005), and "Hooking Your Solver to AMPL" (1997).
StatedProgramme read_nl(const std::string& path);

}  // namespace prospect

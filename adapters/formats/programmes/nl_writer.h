// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "problems/stated_programme.h"

namespace prospect {

/// The programme as a file .nl of AMPL in its text form, with numbers that are read back to the
/// bit. Every variable counts as nonlinear, in objective and constraints, and every row as
/// nonlinear; what is used twice is a defined variable. Lines have no comments but `comment`, which
/// ends the first.
/// Source: D. M. Gay, "Writing .nl Files" (2005).
std::string nl_text(const StatedProgramme& programme, const std::string& comment);

}  // namespace prospect

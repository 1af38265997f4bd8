// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "problems/stated_programme.h"

namespace prospect {

/// The programme as a file of Python that builds it with CasADi: x (SX), f, g, lbx, ubx, lbg, ubg,
/// x0, and nlp = {"x": x, "f": f, "g": g}, what nlpsol() takes. Numbers are read back to the bit.
std::string casadi_text(const StatedProgramme& programme, const std::string& comment);

}  // namespace prospect

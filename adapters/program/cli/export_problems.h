// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/config/registries.h"
#include "adapters/program/cli/interrupt.h"

namespace prospect {

struct ProblemExport {
  std::string problems;  ///< a problem file or a set, as make_problem_set() takes it
  std::string to;        ///< c, nl or casadi
  std::string folder;    ///< to write to
};

/// Writes each problem of the set as a file of C, AMPL or CasADi (adapters/formats/programmes), and
/// of a problem file a copy beside its file of C; prints their names and how C is compiled. Returns
/// an exit code. Throws InputError, with nothing written, for a problem that the format cannot
/// hold.
int export_problems(const ProblemExport& wanted, const Registries& registries,
                    SignalGuard& signals);

}  // namespace prospect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/problem/lifted_problem.h"
#include "problems/stated_programme.h"

namespace prospect {

/// What others' solvers are told of a programme besides its functions.
struct ProgrammeData {
  ColumnPattern jacobian;                ///< m x n
  Eigen::VectorXd start, lower, upper;   ///< n
  Eigen::VectorXd row_lower, row_upper;  ///< m
};

/// A file of C with the functions of one programme in the plain interface of CasADi's `external`,
/// which is also that of acados' generic functions. NAME is `name` unless PROSPECT_NAME is defined:
///
///   NAME          x, p -> f, g
///   NAME_f, NAME_g, NAME_grad_f, NAME_jac_g, NAME_grad   what CasADi's nlpsol looks for by name
///   jac_NAME      what CasADi looks for to differentiate NAME
///   NAME_problem  -> x0, lbx, ubx, lbg, ubg
///
/// each with _n_in, _n_out, _name_in, _name_out, _sparsity_in, _sparsity_out, _work, _incref,
/// _decref, _checkout, _release, _alloc_mem, _init_mem, _free_mem. p is empty. Results that are
/// not asked for may be null; 1 is returned where the functions are not defined. Whole numbers are
/// `casadi_int`, long long int unless it is defined. Thread-safe.
///
/// Of expressions: the file needs nothing but libm. The derivatives are those of Expression, with
/// the same bits where libm is the same. name: an identifier of C.
std::string c_text(const StatedProgramme& programme, const std::string& name,
                   const std::string& comment);

/// Of a problem file, through the library prospect_external (prospect_external.h), which reads
/// `file`, or the file of that name beside the shared library that this text becomes. The same
/// functions, and those of LiftedProblem, `stages`, as NAME_stages or PROSPECT_STAGES_NAME.
std::string c_text_of_file(const std::string& file, const ProgrammeData& whole,
                           const ProgrammeData& stages, const std::string& name,
                           const std::string& comment);

}  // namespace prospect

/* SPDX-License-Identifier: Apache-2.0 */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// A problem of a problem file, as what calls it was written for it; another file is an error.
struct prospect_external_problem {
  /// Its path. Where that is none, the file of this name beside the program or shared library that
  /// holds the address `beside` is taken.
  const char* file;
  const void* beside;
  /// 0: the problem as it is, min f(x), g(x) = c(x) >= 0. 1: with its states as variables
  /// (engine/problem/lifted_problem.h).
  int by_stages;
  long long int n;         ///< variables
  long long int m;         ///< rows of g
  long long int nonzeros;  ///< of the pattern of g's Jacobian
};

/// Where the results go; null: not wanted.
struct prospect_external_values {
  double* f;         ///< 1
  double* gradient;  ///< n
  double* g;         ///< m
  double* jacobian;  ///< nonzeros, column by column: ColumnPattern of lifted_problem.h
};

/// Value and derivatives at x (n), for programs in C: what the files that `prospect export --to c`
/// writes call. The problem file is read once, at the first call.
///
/// Returns 0; or 1 where some term is not evaluable at x; or 2, with a line on standard error the
/// first time, for a file that cannot be read or is another. Thread-safe.
int prospect_external_evaluate(const struct prospect_external_problem* problem, const double* x,
                               const struct prospect_external_values* values);

#ifdef __cplusplus
}
#endif

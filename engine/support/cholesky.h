// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

/// Eigen's Cholesky decompositions that several files use, compiled once, in cholesky.cc, as
/// eigenvalues.h does it: to save, solve() needs a vector, no expression.
namespace Eigen {

extern template LDLT<Matrix3d>& LDLT<Matrix3d>::compute(const EigenBase<Matrix3d>&);
extern template LDLT<Matrix<double, 6, 6>>& LDLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
extern template void LDLT<Matrix3d>::_solve_impl_transposed<true>(const Vector3d&, Vector3d&) const;
extern template void LDLT<Matrix<double, 6, 6>>::_solve_impl_transposed<true>(
    const Matrix<double, 6, 1>&, Matrix<double, 6, 1>&) const;
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

}  // namespace Eigen

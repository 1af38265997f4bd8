// SPDX-License-Identifier: Apache-2.0
#include "engine/support/cholesky.h"

namespace Eigen {

template LDLT<Matrix3d>& LDLT<Matrix3d>::compute(const EigenBase<Matrix3d>&);
template LDLT<Matrix<double, 6, 6>>& LDLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
template void LDLT<Matrix3d>::_solve_impl_transposed<true>(const Vector3d&, Vector3d&) const;
template void LDLT<Matrix<double, 6, 6>>::_solve_impl_transposed<true>(const Matrix<double, 6, 1>&,
                                                                       Matrix<double, 6, 1>&) const;
template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

}  // namespace Eigen

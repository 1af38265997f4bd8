// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

namespace prospect {

/// A text file of `rows` lines of `columns` numbers; empty lines are skipped. `expected` says in
/// messages what it is. Numbers that are not finite are errors unless they are allowed. Throws
/// InputError, one line with the number of the line in the file.
Eigen::MatrixXd read_matrix(const std::string& path, int rows, int columns,
                            const std::string& expected, bool finite = true);

}  // namespace prospect

#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <string>
#include <vector>

/// Between numpy and Eigen. What goes in is copied, or read during the call; what comes out owns
/// its memory or keeps alive what does, so that no array ever outlives its numbers.
namespace prospect::python {

namespace py = pybind11;

/// Numbers as numpy stores them by default; a list or another type is converted.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

/// "(3, 20)"
std::string shape_text(const py::array& array);

/// Throws std::invalid_argument "NAME: has shape (3,); expected (20,)" unless the array has that
/// shape; -1 stands for any length.
void check_shape(const py::array& array, const std::vector<py::ssize_t>& expected,
                 const std::string& name);

/// The numbers of an array of shape (size,); -1: of any length.
Eigen::VectorXd vector_of(const Numbers& array, py::ssize_t size, const std::string& name);

/// The transpose of an array of shape (rows, columns): candidates, one a row, as columns.
Eigen::MatrixXd transposed(const Numbers& array, py::ssize_t rows, py::ssize_t columns,
                           const std::string& name);

/// A new array of this shape, filled row by row from `data`.
Numbers array_of(const double* data, const std::vector<py::ssize_t>& shape);
Numbers array_of(const Eigen::VectorXd& v);
/// (rows, columns)
Numbers array_of(const Eigen::MatrixXd& m);

/// A view of numbers that `owner` holds; it keeps the owner alive. Strides in numbers.
inline py::array view_of(const double* data, const std::vector<py::ssize_t>& shape,
                         const std::vector<py::ssize_t>& strides, const py::object& owner) {
  std::vector<py::ssize_t> bytes;
  for (const py::ssize_t s : strides) {
    bytes.push_back(s * static_cast<py::ssize_t>(sizeof(double)));
  }
  return py::array(py::dtype::of<double>(), shape, bytes, data, owner);
}

}  // namespace prospect::python

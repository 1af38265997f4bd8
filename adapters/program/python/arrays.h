// SPDX-License-Identifier: Apache-2.0
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

/// Numbers as numpy stores them by default.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

/// An argument that is an array, or what numpy makes one of: as it was given. A function takes
/// this type, and reads it by one of the functions below, which let no number become another one.
/// pybind11's own array types convert whatever comes, a probability of 0.5 to the voxel 0.
struct ArrayLike {
  py::object given;
};

/// "(3, 20)"
std::string shape_text(const py::array& array);

/// Throws std::invalid_argument "NAME: has shape (3,); expected (20,)" unless the array has that
/// shape; -1 stands for any length.
void check_shape(const py::array& array, const std::vector<py::ssize_t>& expected,
                 const std::string& name);

/// Which numbers an array may hold: all, for what says itself that a number is no number, or those
/// that are.
enum class Entries { kAny, kFinite };

/// Real numbers, of any shape, each exactly the one given. Throws py::type_error, "NAME: has dtype
/// bool; expected real numbers", for what is no array, a masked one, and one of other types than
/// int, uint and float of up to 64 bits; std::invalid_argument, "NAME: holds nan at (2,); expected
/// finite numbers", for entries that are not to be, and for whole numbers that no double holds.
Numbers numbers_of(const ArrayLike& array, const std::string& name, Entries entries);
/// The same of this shape (check_shape()).
Numbers numbers_of(const ArrayLike& array, const std::vector<py::ssize_t>& shape,
                   const std::string& name, Entries entries = Entries::kFinite);

/// Whole numbers 0..most that stand for something, of this shape; `expected` lists them. Throws as
/// numbers_of(); also for floats that are whole: they are probabilities, and stand for other
/// things.
Bytes codes_of(const ArrayLike& array, const std::vector<py::ssize_t>& shape, int most,
               const std::string& name, const std::string& expected);

/// The numbers of an array of shape (size,); -1: of any length.
Eigen::VectorXd vector_of(const ArrayLike& array, py::ssize_t size, const std::string& name,
                          Entries entries = Entries::kFinite);

/// One number: of Python, or an array with one entry; nan is one, too. Throws as numbers_of(),
/// "cost: has shape (2,); expected one number".
double number_of(const py::object& given, const std::string& name);

/// One whole number of 32 bits: an int of Python or numpy. Throws py::type_error, "rows: is of type
/// float; expected an int", or std::invalid_argument, "rows: is 1180591620717411303424; expected an
/// int of 32 bits".
int whole_of(const py::handle& given, const std::string& name);

/// `seconds`. Throws std::invalid_argument unless they are 0 or more.
double checked_deadline(double seconds);

/// "0.1", "1e+300"
std::string number_text(double number);

/// The transpose of an array of shape (rows, columns): candidates, one a row, as columns.
Eigen::MatrixXd transposed(const ArrayLike& array, py::ssize_t rows, py::ssize_t columns,
                           const std::string& name, Entries entries = Entries::kFinite);

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

namespace pybind11::detail {

/// Takes anything: who reads it knows the argument's name.
template <>
struct type_caster<prospect::python::ArrayLike> {
  PYBIND11_TYPE_CASTER(prospect::python::ArrayLike, const_name("ArrayLike"));
  bool load(handle source, bool) {
    value.given = reinterpret_borrow<object>(source);
    return true;
  }
};

}  // namespace pybind11::detail

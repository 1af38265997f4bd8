// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include "models/formatted.h"

namespace prospect::python {
namespace {

constexpr py::ssize_t kMostCodes = 400'000'000;

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string text = "(";
  for (std::size_t n = 0; n < shape.size(); ++n) {
    text += (n > 0 ? ", " : "") + (shape[n] < 0 ? std::string("any") : std::to_string(shape[n]));
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

/// As given, without a copy where it is an array; of reals.
py::array real_array(const ArrayLike& array, const std::string& name, const char* expected) {
  const py::object& given = array.given;
  const auto& numpy = py::detail::npy_api::get();
  // Almost always it is a plain array.
  if (Py_TYPE(given.ptr()) != numpy.PyArray_Type_ &&
      py::isinstance(given, py::module_::import("numpy.ma").attr("MaskedArray"))) {
    throw py::type_error(name + ": is a masked array; expected one without a mask");
  }
  const py::array plain = py::array::ensure(given);
  if (!plain) {
    throw py::type_error(name + ": is of type " +
                         std::string(py::str(py::type::of(given).attr("__name__"))) +
                         ", which makes no array; expected " + expected);
  }
  const char kind = plain.dtype().kind();
  if ((kind != 'f' && kind != 'i' && kind != 'u') || plain.itemsize() > 8) {
    throw py::type_error(name + ": has dtype " + std::string(py::str(plain.dtype())) +
                         "; expected " + expected);
  }
  return plain;
}

/// As numbers of another type, in C's order. Of reals nothing but memory can be short.
template <typename Array>
Array converted(const py::array& given) {
  Array numbers = Array::ensure(given);
  if (!numbers) throw std::bad_alloc();
  return numbers;
}

/// "0.5 at (2, 0)"
std::string entry_text(const py::array& array, py::ssize_t n) {
  std::vector<py::ssize_t> at(static_cast<std::size_t>(array.ndim()));
  py::ssize_t rest = n;
  for (py::ssize_t axis = array.ndim(); axis-- > 0;) {
    at[static_cast<std::size_t>(axis)] = rest % array.shape(axis);
    rest /= array.shape(axis);
  }
  return std::string(py::str(array.attr("flat")[py::int_(n)])) +
         (at.empty() ? "" : " at " + shape_text(at));
}

/// Throws unless keep(entry) of all.
template <typename Array, typename Keep>
void check_entries(const py::array& given, const Array& numbers, const std::string& name,
                   const std::string& expected, Keep&& keep) {
  for (py::ssize_t n = 0; n < numbers.size(); ++n) {
    if (keep(numbers.data()[n])) continue;
    throw std::invalid_argument(name + ": holds " + entry_text(given, n) + "; expected " +
                                expected);
  }
}

}  // namespace

std::string shape_text(const py::array& array) {
  return shape_text(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()));
}

void check_shape(const py::array& array, const std::vector<py::ssize_t>& expected,
                 const std::string& name) {
  bool same = array.ndim() == static_cast<py::ssize_t>(expected.size());
  for (std::size_t n = 0; same && n < expected.size(); ++n) {
    same = expected[n] < 0 || array.shape(static_cast<py::ssize_t>(n)) == expected[n];
  }
  if (!same) {
    throw std::invalid_argument(name + ": has shape " + shape_text(array) + "; expected " +
                                shape_text(expected));
  }
}

Numbers numbers_of(const ArrayLike& array, const std::string& name, Entries entries) {
  const py::array given = real_array(array, name, "real numbers");
  const Numbers numbers = converted<Numbers>(given);
  if (entries == Entries::kFinite) {
    check_entries(given, numbers, name, "finite numbers",
                  [](double x) { return std::isfinite(x); });
  }
  if (given.itemsize() == 8 && given.dtype().kind() != 'f') {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    check_entries(given, numbers, name, "whole numbers up to 2^53",
                  [](double x) { return std::abs(x) < kExact; });
  }
  return numbers;
}

Numbers numbers_of(const ArrayLike& array, const std::vector<py::ssize_t>& shape,
                   const std::string& name, Entries entries) {
  check_shape(real_array(array, name, "real numbers"), shape, name);
  return numbers_of(array, name, entries);
}

Bytes codes_of(const ArrayLike& array, const std::vector<py::ssize_t>& shape, int most,
               const std::string& name, const std::string& expected) {
  const py::array given = real_array(array, name, "whole numbers");
  check_shape(given, shape, name);
  if (given.size() > kMostCodes) {
    throw std::invalid_argument(name + ": has " + std::to_string(given.size()) +
                                " entries; expected at most " + std::to_string(kMostCodes));
  }
  if (given.size() == 0) throw std::invalid_argument(name + ": is empty; expected one or more");
  const bool whole = given.dtype().kind() != 'f';
  // Doubles of all entries take eight times the room, and are needed to say what is wrong alone.
  if (!whole || given.attr("min")().cast<double>() < 0.0 ||
      given.attr("max")().cast<double>() > most) {
    // What is beyond 2^53 or not whole is not one of them as a double, either.
    check_entries(given, converted<Numbers>(given), name, expected,
                  [most](double x) { return x >= 0.0 && x <= most && x == std::floor(x); });
  }
  if (!whole) {
    throw py::type_error(name + ": has dtype " + std::string(py::str(given.dtype())) +
                         "; expected whole numbers");
  }
  return converted<Bytes>(given);
}

Eigen::VectorXd vector_of(const ArrayLike& array, py::ssize_t size, const std::string& name,
                          Entries entries) {
  const Numbers numbers = numbers_of(array, {size}, name, entries);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
}

double number_of(const py::object& given, const std::string& name) {
  if (PyFloat_CheckExact(given.ptr())) return PyFloat_AS_DOUBLE(given.ptr());
  const Numbers numbers = numbers_of(ArrayLike{given}, name, Entries::kAny);
  if (numbers.size() != 1) {
    throw std::invalid_argument(name + ": has shape " + shape_text(numbers) +
                                "; expected one number");
  }
  return numbers.data()[0];
}

int whole_of(const py::handle& given, const std::string& name) {
  if (!PyIndex_Check(given.ptr())) {
    throw py::type_error(name + ": is of type " +
                         std::string(py::str(py::type::of(given).attr("__name__"))) +
                         "; expected an int");
  }
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!whole) throw py::error_already_set();
  int overflow = 0;
  const long number = PyLong_AsLongAndOverflow(whole.ptr(), &overflow);
  if (overflow != 0 || number < std::numeric_limits<int>::min() ||
      number > std::numeric_limits<int>::max()) {
    throw std::invalid_argument(name + ": is " + std::string(py::str(whole)) +
                                "; expected an int of 32 bits");
  }
  return static_cast<int>(number);
}

double checked_deadline(double seconds) {
  if (seconds >= 0.0) return seconds;
  throw std::invalid_argument("deadline: is " + number_text(seconds) +
                              " s; expected 0 or more, or None");
}

std::string number_text(double number) { return formatted("%.9g", number); }

Eigen::MatrixXd transposed(const ArrayLike& array, py::ssize_t rows, py::ssize_t columns,
                           const std::string& name, Entries entries) {
  const Numbers numbers = numbers_of(array, {rows, columns}, name, entries);
  return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), numbers.shape(1), numbers.shape(0));
}

Numbers array_of(const double* data, const std::vector<py::ssize_t>& shape) {
  Numbers array(shape);
  std::copy_n(data, array.size(), array.mutable_data());
  return array;
}

Numbers array_of(const Eigen::VectorXd& v) { return array_of(v.data(), {v.size()}); }

Numbers array_of(const Eigen::MatrixXd& m) {
  Numbers array(std::vector<py::ssize_t>{m.rows(), m.cols()});
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      array.mutable_data(), m.rows(), m.cols()) = m;
  return array;
}

}  // namespace prospect::python

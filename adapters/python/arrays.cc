#include "adapters/python/arrays.h"

#include <algorithm>
#include <stdexcept>

namespace prospect::python {
namespace {

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string text = "(";
  for (std::size_t n = 0; n < shape.size(); ++n) {
    text += (n > 0 ? ", " : "") + (shape[n] < 0 ? std::string("any") : std::to_string(shape[n]));
  }
  return text + (shape.size() == 1 ? ",)" : ")");
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

Eigen::VectorXd vector_of(const Numbers& array, py::ssize_t size, const std::string& name) {
  check_shape(array, {size}, name);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
}

Eigen::MatrixXd transposed(const Numbers& array, py::ssize_t rows, py::ssize_t columns,
                           const std::string& name) {
  check_shape(array, {rows, columns}, name);
  return Eigen::Map<const Eigen::MatrixXd>(array.data(), array.shape(1), array.shape(0));
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

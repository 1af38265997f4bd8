// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <string>

#include "adapters/program/python/bindings.h"

namespace prospect::python {

namespace py = pybind11;

void refuse_copies(py::module_& m) {
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(m.attr("__dict__"))) {
    if (!PyType_Check(value.ptr()) || py::hasattr(value, "__members__")) continue;
    if (!py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr()))) continue;
    // As object.__reduce_ex__: what pickle, copy and deepcopy ask.
    value.attr("__reduce_ex__") = py::cpp_function(
        [](const py::object& self, int) {
          throw py::type_error(
              std::string(py::str(py::type::of(self).attr("__name__"))) +
              ": cannot be pickled or copied, as it lives in this process; expected what it is "
              "made of (the path of its file, arrays, settings) to be handed on");
        },
        py::name("__reduce_ex__"), py::is_method(value));
  }
}

}  // namespace prospect::python

// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/callback.h"

namespace prospect::python {
namespace {

/// "FILE:LINE" of the innermost frame that is not of an installed library; else of the innermost;
/// "" without a traceback.
std::string place_of(const py::error_already_set& error) {
  std::string innermost, own;
  for (py::object at = error.trace(); at && !at.is_none(); at = at.attr("tb_next")) {
    const std::string file = py::str(at.attr("tb_frame").attr("f_code").attr("co_filename"));
    innermost = file + ":" + std::string(py::str(at.attr("tb_lineno")));
    if (file.find("-packages/") == std::string::npos) own = innermost;
  }
  return own.empty() ? innermost : own;
}

std::string one_line(const std::string& where, const py::error_already_set& error) {
  const std::string place = place_of(error);
  const std::string type = py::str(error.type().attr("__name__"));
  std::string text = where + ": " + type;
  const std::string message = error.value() ? std::string(py::str(error.value())) : "";
  if (!message.empty()) text += ": " + message;
  if (!place.empty()) text += " (" + place + ")";
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

}  // namespace

CallbackError::CallbackError(const std::string& where, const py::error_already_set& error)
    : std::runtime_error(one_line(where, error)), exception_(shared_object(error.value())) {}

std::shared_ptr<py::object> shared_object(py::object object) {
  return {new py::object(std::move(object)), [](py::object* o) {
            const py::gil_scoped_acquire gil;
            delete o;
          }};
}

}  // namespace prospect::python

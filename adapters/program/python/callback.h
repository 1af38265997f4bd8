// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

/// What stands between the engine and functions written in Python.
namespace prospect::python {

namespace py = pybind11;

/// An exception of a function written in Python, as one that may cross any thread: what() is one
/// line, "WHERE: TYPE: MESSAGE (FILE:LINE)", with the innermost line that is not of a library.
class CallbackError : public std::runtime_error {
 public:
  /// Takes the pending exception of the interpreter over. The thread holds the GIL.
  CallbackError(const std::string& where, const py::error_already_set& error);

  /// The exception itself, with its traceback. The thread holds the GIL.
  py::object exception() const { return *exception_; }

 private:
  std::shared_ptr<py::object> exception_;
};

/// An object of Python that may be copied and destroyed on any thread, with the GIL or without.
std::shared_ptr<py::object> shared_object(py::object object);

/// Calls an object of Python from the engine: takes the GIL, one thread at a time, and turns
/// exceptions into CallbackError. A call may lead back to the same object on the same thread.
///
/// Thread-safety: all methods from any thread, with the GIL or without.
class Callback {
 public:
  /// `what`: how errors name it. The thread holds the GIL.
  Callback(py::object object, std::string what)
      : object_(shared_object(std::move(object))),
        what_(std::move(what)),
        mutex_(std::make_shared<std::recursive_mutex>()) {}

  /// f(object), where the GIL is held; throws CallbackError, and passes on what else f throws.
  template <typename Function>
  auto operator()(const std::string& where, Function&& f) const {
    // The GIL is given up while the turn is waited for: who has the turn may need it.
    std::unique_lock<std::recursive_mutex> turn(*mutex_, std::defer_lock);
    if (PyGILState_Check()) {
      const py::gil_scoped_release release;
      turn.lock();
    } else {
      turn.lock();
    }
    const py::gil_scoped_acquire gil;
    try {
      return f(*object_);
    } catch (const py::error_already_set& error) {
      throw CallbackError(where.empty() ? what_ : what_ + "." + where, error);
    } catch (const py::cast_error& error) {
      throw std::runtime_error((where.empty() ? what_ : what_ + "." + where) + ": " + error.what());
    }
  }

  const std::string& what() const { return what_; }

 private:
  std::shared_ptr<py::object> object_;
  std::string what_;
  std::shared_ptr<std::recursive_mutex> mutex_;
};

}  // namespace prospect::python

// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/trajectories.h"

#include "adapters/program/python/arrays.h"

namespace prospect::python {

Trajectories::Trajectories(const TrajectoryBatch& batch)
    : B(batch.batch()),
      N(batch.horizon.N),
      nx(batch.horizon.nx()),
      nu(batch.horizon.nu()),
      dt(batch.horizon.dt),
      layout(batch.layout),
      u_previous(batch.u_previous),
      states(B * (N + 1) * nx),
      inputs(B * N * nu),
      poses(B * (N + 1) * 4) {
  for (int b = 0; b < B; ++b) {
    states.segment(b * (N + 1) * nx, (N + 1) * nx) = batch.states.col(b).matrix();
    inputs.segment(b * N * nu, N * nu) = batch.inputs.col(b).matrix();
    for (int k = 0; k <= N; ++k) {
      double* const pose = poses.data() + (b * (N + 1) + k) * 4;
      pose[0] = batch.px(k, b);
      pose[1] = batch.py(k, b);
      pose[2] = batch.pz(k, b);
      pose[3] = batch.yaw(k, b);
    }
  }
}

void bind_trajectories(py::module_& m) {
  using T = Trajectories;
  const auto view = [](const py::object& self, const Eigen::VectorXd& v, int rows, int columns) {
    const int B = self.cast<const T&>().B;
    return view_of(v.data(), {B, rows, columns}, {rows * columns, columns, 1}, self);
  };
  py::class_<T>(m, "Trajectories",
                "B trajectories over N stages of dt seconds. Stage k goes from x[k] to x[k+1]. All "
                "arrays are in W, SI units, rad.")
      .def_property_readonly(
          "states",
          [view](const py::object& self) {
            const T& t = self.cast<const T&>();
            return view(self, t.states, t.N + 1, t.nx);
          },
          "(B, N+1, nx): states of the motion model.")
      .def_property_readonly(
          "inputs",
          [view](const py::object& self) {
            const T& t = self.cast<const T&>();
            return view(self, t.inputs, t.N, t.nu);
          },
          "(B, N, nu): inputs, held over a stage.")
      .def_property_readonly(
          "poses",
          [view](const py::object& self) {
            const T& t = self.cast<const T&>();
            return view(self, t.poses, t.N + 1, 4);
          },
          "(B, N+1, 4): x, y, z [m] and yaw [rad], not wrapped.")
      .def_property_readonly(
          "u_previous", [](const T& t) { return array_of(t.u_previous); },
          "(nu,): the input in force before the first stage.")
      .def_property_readonly(
          "times",
          [](const T& t) {
            return array_of(Eigen::VectorXd::LinSpaced(t.N + 1, 0.0, t.N * t.dt).eval());
          },
          "(N+1,): from the present on [s].")
      .def_readonly("B", &T::B, "Trajectories.")
      .def_readonly("N", &T::N, "Stages.")
      .def_readonly("nx", &T::nx, "Entries of a state.")
      .def_readonly("nu", &T::nu, "Entries of an input.")
      .def_readonly("dt", &T::dt, "Duration of a stage [s].")
      .def("__repr__", [](const T& t) {
        return "Trajectories(B=" + std::to_string(t.B) + ", N=" + std::to_string(t.N) + ")";
      });
}

}  // namespace prospect::python

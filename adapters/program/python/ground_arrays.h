// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/maps/ground_map.h"

namespace prospect::python {

/// A ground map as (ny, nx) uint8, 0 unknown, 1 free, 2 occupied, row j at y, and its (left, right,
/// bottom, top) [m].
inline pybind11::tuple ground_arrays(const GroundMap& ground) {
  const GridFrame& f = ground.frame();
  pybind11::array_t<std::uint8_t> array(std::vector<pybind11::ssize_t>{f.height, f.width});
  std::transform(ground.cells().data.begin(), ground.cells().data.end(), array.mutable_data(),
                 [](CellState c) { return static_cast<std::uint8_t>(c); });
  return pybind11::make_tuple(
      array, pybind11::make_tuple(f.i0 * f.resolution, (f.i0 + f.width) * f.resolution,
                                  f.j0 * f.resolution, (f.j0 + f.height) * f.resolution));
}

}  // namespace prospect::python

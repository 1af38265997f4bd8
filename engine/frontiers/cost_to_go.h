// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// The cost-to-go V(p) [s at v_max] in a window around the robot: an immutable C2 function.
///
///   V(x, y) = sum_ij B(x/r - i - 1/2) B(y/r - j - 1/2) V_ij,   B the cubic B-spline,
///
/// V_ij the value of cell (i, j), taken as the coefficient: the spline smooths over about a cell
/// and stays between the smallest and the largest of the 16 cells around p. Beyond the window the
/// values of its rim are repeated, so V is finite and C2 in the whole plane. Cubic rather than
/// quadratic, so that what is made of grad V (the heading alignment) still has a continuous
/// gradient.
///
/// Thread-safety: immutable; all methods may be called concurrently. They do not allocate, except
/// descend(). A non-finite p gives NaN.
/// Source: formulation, section 6; the spline's order is our choice.
class CostToGo {
 public:
  /// V = 0 everywhere, nothing reached.
  CostToGo();
  /// seconds: finite values of the cells of a window; reached: 1 where the value comes from the
  /// flooding, 0 where it was filled in; same frame. scale: metres of path equivalent per second
  /// (v_max). Throws std::invalid_argument if the frames differ or are empty or a value is not
  /// finite.
  CostToGo(Grid<double> seconds, Grid<std::uint8_t> reached, double v_max);

  double value(const Eigen::Vector2d& p) const { return value(p.x(), p.y()); }
  double value(double x, double y) const;
  /// gradient [s/m].
  double value(const Eigen::Vector2d& p, Eigen::Vector2d& gradient) const;
  /// hessian [s/m^2], symmetric.
  double value(const Eigen::Vector2d& p, Eigen::Vector2d& gradient, Eigen::Matrix2d& hessian) const;

  /// Points of the path down from p, p first, about half a cell apart: along -grad V while that
  /// leads down inside reached cells, else over the steepest neighbour cell. Ends at a local
  /// minimum of the cells (a viewpoint), at the window's rim or after max_length [m]. From outside
  /// the reached cells it goes to the nearest reached one first.
  std::vector<Eigen::Vector2d> descend(const Eigen::Vector2d& p, double max_length) const;

  const GridFrame& frame() const { return seconds_.frame; }
  double v_max() const { return v_max_; }
  /// The least value of a cell: V is nowhere below it.
  double lowest() const { return lowest_; }
  const Grid<double>& cells() const { return seconds_; }
  bool reached(Cell c) const { return reached_.get(c, 0) != 0; }

 private:
  template <int kOrder>
  void evaluate(double x, double y, double* out) const;

  Grid<double> seconds_;
  Grid<std::uint8_t> reached_;
  double v_max_ = 1.0;
  double lowest_ = 0.0;
};

}  // namespace prospect

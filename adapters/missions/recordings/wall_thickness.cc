// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/wall_thickness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/support/quantile.h"

namespace prospect {

WallThickness wall_thickness(const VoxelGrid& voxels, const WallThicknessOptions& options) {
  const double r = voxels.resolution();
  const GridFrame frame = voxels.frame();
  const int k_low = static_cast<int>(std::ceil(options.z_min / r - 1e-9));
  const int k_end = static_cast<int>(std::floor(options.z_max / r + 1e-9));
  const int least = std::max(1, static_cast<int>(std::lround(options.least / r)));
  Grid<std::uint8_t> wall(frame, 0);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    int occupied = 0;
    for (int k = k_low; k < k_end; ++k) {
      occupied += voxels.state(c.i, c.j, k) == CellState::kOccupied;
    }
    wall[c] = occupied >= least;
  }
  const int window = std::max(1, static_cast<int>(std::lround(options.window / r)));
  const double longest = options.window;
  std::vector<double> thickness;
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    if (!wall[c]) continue;
    double count = 0.0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    for (int dj = -window; dj <= window; ++dj) {
      for (int di = -window; di <= window; ++di) {
        if (di * di + dj * dj > window * window || !wall.get({c.i + di, c.j + dj}, 0)) continue;
        const Eigen::Vector2d d(di, dj);
        count += 1.0;
        sum += d;
        squares += d * d.transpose();
      }
    }
    const Eigen::Matrix2d covariance = squares / count - sum * sum.transpose() / (count * count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance);
    // Long enough to have a direction: as spread out as a line over half of the window.
    if (eigen.eigenvalues()[1] < window * window / 12.0 ||
        eigen.eigenvalues()[0] > options.straight * eigen.eigenvalues()[1]) {
      continue;
    }
    const Eigen::Vector2d normal = eigen.eigenvectors().col(0);
    double reach[2] = {0.0, 0.0};
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector2d direction = side == 0 ? normal : Eigen::Vector2d(-normal);
      for (double s = 0.5 * r; s - reach[side] <= options.gap + r && s <= longest; s += 0.5 * r) {
        const Eigen::Vector2d p = frame.center(c) + s * direction;
        if (wall.get(frame.cell(p.x(), p.y()), 0)) reach[side] = s;
      }
    }
    thickness.push_back(reach[0] + reach[1] + r);
  }
  WallThickness out;
  out.cells = static_cast<int>(thickness.size());
  out.median = quantile(thickness, 0.5);
  out.p90 = quantile(thickness, 0.9);
  const auto thick = std::count_if(thickness.begin(), thickness.end(),
                                   [&](double t) { return t > options.doubled * r + 1e-9; });
  out.doubled = thickness.empty()
                    ? std::numeric_limits<double>::quiet_NaN()
                    : static_cast<double>(thick) / static_cast<double>(thickness.size());
  return out;
}

}  // namespace prospect

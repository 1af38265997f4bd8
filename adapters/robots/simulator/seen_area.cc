// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/seen_area.h"

#include <algorithm>
#include <limits>

#include "adapters/formats/worlds/sloped_floor.h"

namespace prospect {

SeenArea::SeenArea(const World& world, const HeightSlice& slice)
    : world_(&world),
      layers_(slice_layers(slice, world.voxels.resolution())),
      voxels_(world.voxels.data().size(), CellState::kUnknown),
      levels_(floor_levels(world).data) {
  const auto columns = static_cast<std::size_t>(world.voxels.frame().size());
  free_.assign(columns, 0);
  column_.assign(columns, 0);
  reachable_cells_.assign(columns, 0);
}

DepthScan SeenArea::look(DepthCamera& camera, const Pose& true_pose,
                         std::span<const Walker> walkers) {
  newly_seen_.clear();
  DepthScan scan = camera.sense(true_pose, &voxels_, &newly_seen_, walkers);
  const auto depth_layers = static_cast<std::uint32_t>(world_->voxels.depth());
  for (const std::uint32_t index : newly_seen_) {
    const std::uint32_t column = index / depth_layers;
    const int k = world_->voxels.k0() + static_cast<int>(index % depth_layers) - levels_[column];
    if (k < layers_.k_low || k > layers_.k_high) continue;
    if (column_[column] != 0) continue;
    const bool solid = voxels_[index] == CellState::kOccupied;
    if (!solid) ++free_[column];
    if (project_column(solid ? 1 : 0, free_[column]) == CellState::kUnknown) continue;
    column_[column] = 1;
    reachable_seen_ += reachable_cells_[column];
  }
  return scan;
}

void SeenArea::know(const GroundMap& map) {
  const GridFrame& frame = world_->voxels.frame();
  for (int n = 0; n < frame.size(); ++n) {
    const Eigen::Vector2d center = frame.center(frame.at(n));
    const auto column = static_cast<std::size_t>(n);
    if (column_[column] != 0 || !map.explored(map.frame().cell(center.x(), center.y()))) continue;
    column_[column] = 1;
    reachable_seen_ += reachable_cells_[column];
  }
}

void SeenArea::set_reachable(const Grid<std::uint8_t>& reachable) {
  const GridFrame& frame = world_->voxels.frame();
  std::fill(reachable_cells_.begin(), reachable_cells_.end(), 0);
  reachable_total_ = 0;
  reachable_seen_ = 0;
  cell_area_ = reachable.frame.resolution * reachable.frame.resolution;
  for (int n = 0; n < reachable.frame.size(); ++n) {
    if (reachable.data[static_cast<std::size_t>(n)] == 0) continue;
    ++reachable_total_;
    // The cell stands for the column that holds its centre.
    const Eigen::Vector2d center = reachable.frame.center(reachable.frame.at(n));
    const Cell column = frame.cell(center.x(), center.y());
    if (!frame.contains(column)) continue;
    const auto index = static_cast<std::size_t>(frame.index(column));
    ++reachable_cells_[index];
    reachable_seen_ += column_[index] != 0 ? 1 : 0;
  }
}

double SeenArea::coverage() const {
  return reachable_total_ == 0
             ? std::numeric_limits<double>::quiet_NaN()
             : static_cast<double>(reachable_seen_) / static_cast<double>(reachable_total_);
}

double SeenArea::area() const { return static_cast<double>(reachable_seen_) * cell_area_; }

bool SeenArea::seen(Cell true_cell) const {
  const GridFrame& frame = world_->voxels.frame();
  return frame.contains(true_cell) &&
         column_[static_cast<std::size_t>(frame.index(true_cell))] != 0;
}

}  // namespace prospect

#include "engine/occlusion_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

namespace prospect {
namespace {

// Rows start at multiples of this many floats, so that loops over points need no remainder.
constexpr int kPadding = 8;

// Which 8 x 8 column tiles hold a voxel that differs between two snapshots, with a summed-area
// table so that "none in this rectangle" is one look-up of four numbers.
class ChangedTiles {
 public:
  // Compares the columns of cells [lo, hi].
  ChangedTiles(const VoxelGrid& now, const VoxelGrid& before, Cell lo, Cell hi) {
    per_meter_ = 1.0 / now.resolution();
    lo_ = {tile(lo.i), tile(lo.j)};
    nx_ = tile(hi.i) - lo_.i + 1;
    ny_ = tile(hi.j) - lo_.j + 1;
    sums_.assign(static_cast<std::size_t>((nx_ + 1) * (ny_ + 1)), 0);
    const bool comparable = now.resolution() == before.resolution() && now.k0() == before.k0() &&
                            now.depth() == before.depth();
    for (int b = 0; b < ny_; ++b) {
      int in_row = 0;
      for (int a = 0; a < nx_; ++a) {
        in_row += !comparable || differs(now, before, lo_.i + a, lo_.j + b);
        sums_[at(a + 1, b + 1)] = sums_[at(a + 1, b)] + in_row;
      }
    }
  }

  bool any() const { return sums_.back() > 0; }

  // Tile of a position, clamped into the compared rectangle.
  Cell tile_at(const Eigen::Vector3d& p) const { return {tile_x(p.x()), tile_y(p.y())}; }

  // Whether the segment may pass a changed tile, given the tiles of its ends (widened by a tile
  // where an end lies on a face): by its bounding rectangle, then by those of its quarters.
  bool any(const Eigen::Vector3d& from, Cell from_tile, const Eigen::Vector3d& to,
           Cell to_tile) const {
    if (!any_in(std::min(from_tile.i, to_tile.i) - 1, std::min(from_tile.j, to_tile.j) - 1,
                std::max(from_tile.i, to_tile.i) + 1, std::max(from_tile.j, to_tile.j) + 1)) {
      return false;
    }
    constexpr int kParts = 4;
    double x = from.x(), y = from.y();
    for (int n = 1; n <= kParts; ++n) {
      const double f = static_cast<double>(n) / kParts;
      const double next_x = from.x() + f * (to.x() - from.x());
      const double next_y = from.y() + f * (to.y() - from.y());
      if (any_between(x, y, next_x, next_y)) return true;
      x = next_x;
      y = next_y;
    }
    return false;
  }

 private:
  static constexpr int kShift = 3;

  bool any_between(double x0, double y0, double x1, double y1) const {
    // The margin covers the rounding of a ray along a face between two tiles.
    constexpr double kMargin = 1e-6;
    return any_in(tile_x(std::min(x0, x1) - kMargin), tile_y(std::min(y0, y1) - kMargin),
                  tile_x(std::max(x0, x1) + kMargin), tile_y(std::max(y0, y1) + kMargin));
  }
  bool any_in(int a0, int b0, int a1, int b1) const {
    a0 = std::max(a0, 0);
    b0 = std::max(b0, 0);
    a1 = std::min(a1 + 1, nx_);
    b1 = std::min(b1 + 1, ny_);
    return sums_[at(a1, b1)] - sums_[at(a0, b1)] - sums_[at(a1, b0)] + sums_[at(a0, b0)] > 0;
  }

  static int tile(int cell) { return cell >> kShift; }
  int cell(double p) const {
    const double c = p * per_meter_;
    const int truncated = static_cast<int>(c);
    return truncated - (c < truncated);
  }
  int tile_x(double x) const { return std::clamp(tile(cell(x)) - lo_.i, 0, nx_ - 1); }
  int tile_y(double y) const { return std::clamp(tile(cell(y)) - lo_.j, 0, ny_ - 1); }
  std::size_t at(int a, int b) const { return static_cast<std::size_t>(b * (nx_ + 1) + a); }

  static bool differs(const VoxelGrid& now, const VoxelGrid& before, int tx, int ty) {
    constexpr int kSide = 1 << kShift;
    const int i0 = tx * kSide;
    const auto whole_run = [&](const VoxelGrid& g, int j) {
      return g.frame().contains({i0, j}) && g.frame().contains({i0 + kSide - 1, j});
    };
    const auto depth = static_cast<std::size_t>(now.depth());
    for (int j = ty * kSide; j < (ty + 1) * kSide; ++j) {
      if (whole_run(now, j) && whole_run(before, j)) {
        static_assert(sizeof(CellState) == 1);
        if (std::memcmp(now.data().data() + now.index(i0, j, now.k0()),
                        before.data().data() + before.index(i0, j, before.k0()),
                        static_cast<std::size_t>(kSide) * depth) != 0) {
          return true;
        }
        continue;
      }
      for (int i = i0; i < i0 + kSide; ++i) {
        for (int k = now.k0(); k < now.k0() + now.depth(); ++k) {
          if (now.state(i, j, k) != before.state(i, j, k)) return true;
        }
      }
    }
    return false;
  }

  Cell lo_;
  double per_meter_ = 1.0;
  int nx_ = 0, ny_ = 0;
  std::vector<int> sums_;
};

struct PositionHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::size_t h = 0;
    for (double v : p) h = h * 0x9E3779B97F4A7C15ull + std::hash<double>{}(v);
    return h;
  }
};

std::array<double, 3> key(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

// Weights of the quadratic B-spline at nodes first .. first + 2, and their derivatives.
struct Weights {
  int first = 0;
  int count = 3;
  std::array<double, 3> w{};
  std::array<double, 3> d{};
};

Weights spline_weights(double position, double spacing, int nodes) {
  Weights r;
  if (nodes == 1) {
    r.count = 1;
    r.w = {1.0, 0.0, 0.0};
    return r;
  }
  const double low = 0.5, high = nodes - 1.5;
  const double raw = position / spacing;
  const double s = std::clamp(raw, low, high);
  const int center = std::min(static_cast<int>(s + 0.5), nodes - 2);
  const double f = s - center;
  r.first = center - 1;
  r.w = {0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)};
  if (raw > low && raw < high) r.d = {(f - 0.5) / spacing, -2.0 * f / spacing, (f + 0.5) / spacing};
  return r;
}

}  // namespace

SensorLattice SensorLattice::around(const Eigen::Vector3d& center, double reach, double spacing,
                                    bool vertical) {
  SensorLattice l;
  l.spacing = spacing;
  const auto span = [&](double c, double& origin, int& n) {
    // One node beyond the outermost position on either side: the spline's support is 1.5 spacings.
    const double first = std::floor((c - reach) / spacing) - 1.0;
    const double last = std::ceil((c + reach) / spacing) + 1.0;
    origin = first * spacing;
    n = static_cast<int>(last - first) + 1;
  };
  span(center.x(), l.origin.x(), l.nx);
  span(center.y(), l.origin.y(), l.ny);
  if (vertical) {
    span(center.z(), l.origin.z(), l.nz);
  } else {
    l.origin.z() = center.z();
    l.nz = 1;
  }
  return l;
}

OcclusionTable::OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                               const VoxelGrid& voxels, const Options& options,
                               WorkerThreads* workers)
    : lattice_(lattice), points_(std::move(points)), options_(options) {
  build(voxels, nullptr, workers);
}

OcclusionTable::OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                               std::shared_ptr<const VoxelGrid> voxels, const Options& options,
                               const OcclusionTable* previous, WorkerThreads* workers)
    : lattice_(lattice), points_(std::move(points)), options_(options), voxels_(std::move(voxels)) {
  if (!voxels_) throw std::invalid_argument("occlusion table: voxels is null; expected a snapshot");
  build(*voxels_, previous, workers);
}

Eigen::Vector3d OcclusionTable::node_position(int a, int b, int c) const {
  const Eigen::Array3d address = (lattice_.origin.array() / lattice_.spacing).round();
  const bool vertical = lattice_.nz > 1;
  const auto coordinate = [&](int axis, int n) {
    const double aligned = address[axis] * lattice_.spacing;
    if (std::abs(aligned - lattice_.origin[axis]) < 1e-9 && (axis < 2 || vertical)) {
      return (address[axis] + n) * lattice_.spacing;
    }
    return lattice_.origin[axis] + n * lattice_.spacing;
  };
  return {coordinate(0, a), coordinate(1, b), coordinate(2, c)};
}

void OcclusionTable::build(const VoxelGrid& voxels, const OcclusionTable* previous,
                           WorkerThreads* workers) {
  const SensorLattice& l = lattice_;
  if (!(l.spacing > 0.0) || !std::isfinite(l.spacing) || !l.origin.allFinite()) {
    throw std::invalid_argument("occlusion table: lattice spacing " + std::to_string(l.spacing) +
                                "; expected a finite origin and a positive spacing [m]");
  }
  if (l.nx < 3 || l.ny < 3 || (l.nz != 1 && l.nz < 3)) {
    throw std::invalid_argument("occlusion table: lattice of " + std::to_string(l.nx) + " x " +
                                std::to_string(l.ny) + " x " + std::to_string(l.nz) +
                                " nodes; expected at least 3 x 3 x (1 or at least 3)");
  }
  for (const Eigen::Vector3d& p : points_) {
    if (!p.allFinite()) {
      throw std::invalid_argument("occlusion table: a point is not finite; expected [m] in W");
    }
  }
  stride_ = (num_points() + kPadding - 1) / kPadding * kPadding;
  const std::size_t nodes = static_cast<std::size_t>(l.nx) * static_cast<std::size_t>(l.ny) *
                            static_cast<std::size_t>(l.nz);
  table_.assign(nodes * static_cast<std::size_t>(stride_), 0.0f);
  in_wall_.assign(nodes, 0);

  // What of the previous table may be taken over: a shift of node addresses and the old column of
  // each point (-1: none).
  std::vector<int> old_column;
  Eigen::Vector3i shift = Eigen::Vector3i::Zero();
  std::unique_ptr<ChangedTiles> changed;
  if (previous && previous->voxels_ && previous->options_ == options_ &&
      previous->lattice_.spacing == l.spacing &&
      previous->voxels_->resolution() == voxels.resolution()) {
    const Eigen::Vector3d offset = (l.origin - previous->lattice_.origin) / l.spacing;
    shift = offset.array().round().cast<int>();
    const bool aligned =
        node_position(0, 0, 0) == previous->node_position(shift.x(), shift.y(), shift.z());
    if (aligned) {
      std::unordered_map<std::array<double, 3>, int, PositionHash> columns;
      columns.reserve(previous->points_.size());
      for (int i = 0; i < previous->num_points(); ++i) {
        columns.emplace(key(previous->points_[static_cast<std::size_t>(i)]), i);
      }
      old_column.assign(points_.size(), -1);
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (const auto it = columns.find(key(points_[i])); it != columns.end()) {
          old_column[i] = it->second;
        }
      }
      if (previous->voxels_.get() != &voxels) {
        Eigen::Vector3d low = node_position(0, 0, 0);
        Eigen::Vector3d high = node_position(l.nx - 1, l.ny - 1, l.nz - 1);
        const Eigen::Vector3d farthest_low = low.array() - options_.max_range;
        const Eigen::Vector3d farthest_high = high.array() + options_.max_range;
        for (const Eigen::Vector3d& p : points_) {
          low = low.cwiseMin(p.cwiseMax(farthest_low));
          high = high.cwiseMax(p.cwiseMin(farthest_high));
        }
        const Eigen::Vector3i lo = voxels.voxel(low), hi = voxels.voxel(high);
        changed = std::make_unique<ChangedTiles>(voxels, *previous->voxels_, Cell{lo.x(), lo.y()},
                                                 Cell{hi.x(), hi.y()});
        if (!changed->any()) changed.reset();
      }
    }
  }

  // Rays of one node are cast in the order of the points' distance from the lattice's middle, so
  // that rays abreast have similar lengths.
  const Eigen::Vector3d middle =
      0.5 * (node_position(0, 0, 0) + node_position(l.nx - 1, l.ny - 1, l.nz - 1));
  std::vector<int> order(points_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) {
    return (points_[static_cast<std::size_t>(i)] - middle).squaredNorm() <
           (points_[static_cast<std::size_t>(j)] - middle).squaredNorm();
  });
  std::vector<Cell> point_tile(points_.size());
  if (changed) {
    for (std::size_t i = 0; i < points_.size(); ++i) point_tile[i] = changed->tile_at(points_[i]);
  }

  const double max_squared = options_.max_range * options_.max_range;
  std::vector<std::int64_t> cast(static_cast<std::size_t>(l.ny) * static_cast<std::size_t>(l.nz));
  const auto fill_line = [&](int line) {
    const int b = line % l.ny, c = line / l.ny;
    std::vector<int> wanted;
    std::vector<Eigen::Vector3d> ends;
    std::vector<VoxelGrid::Ray> rays(points_.size());
    wanted.reserve(points_.size());
    ends.reserve(points_.size());
    for (int a = 0; a < l.nx; ++a) {
      const Eigen::Vector3d from = node_position(a, b, c);
      const Eigen::Vector3i v = voxels.voxel(from);
      if (voxels.state(v.x(), v.y(), v.z()) == CellState::kOccupied) {
        in_wall_[static_cast<std::size_t>(line * l.nx + a)] = 1;
        continue;
      }
      const float* old_row = nullptr;
      if (!old_column.empty() && previous->stride_ > 0) {
        const SensorLattice& o = previous->lattice_;
        const int oa = a + shift.x(), ob = b + shift.y(), oc = c + shift.z();
        if (oa >= 0 && oa < o.nx && ob >= 0 && ob < o.ny && oc >= 0 && oc < o.nz) {
          const std::size_t start = previous->row(oa, ob, oc);
          if (!previous->in_wall_[start / static_cast<std::size_t>(previous->stride_)]) {
            old_row = previous->table_.data() + start;
          }
        }
      }
      float* out = table_.data() + row(a, b, c);
      const Cell here = changed ? changed->tile_at(from) : Cell();
      wanted.clear();
      ends.clear();
      for (const int n : order) {
        const auto i = static_cast<std::size_t>(n);
        if ((points_[i] - from).squaredNorm() > max_squared) continue;
        if (old_row && old_column[i] >= 0 &&
            !(changed && changed->any(from, here, points_[i], point_tile[i]))) {
          out[i] = old_row[old_column[i]];
          continue;
        }
        wanted.push_back(n);
        ends.push_back(points_[i]);
      }
      const int count = static_cast<int>(wanted.size());
      cast[static_cast<std::size_t>(line)] += count;
      voxels.cast_many(from, ends.data(), count, options_.trim, rays.data());
      for (int n = 0; n < count; ++n) {
        const VoxelGrid::Ray& ray = rays[static_cast<std::size_t>(n)];
        if (ray.blocked) continue;
        out[wanted[static_cast<std::size_t>(n)]] =
            ray.unknown_length > 0.0
                ? static_cast<float>(std::exp(-options_.attenuation * ray.unknown_length))
                : 1.0f;
      }
    }
  };
  share(workers, l.ny * l.nz, fill_line);
  rays_cast_ = std::accumulate(cast.begin(), cast.end(), std::int64_t{0});
  fill_nodes_in_walls();
}

void OcclusionTable::fill_nodes_in_walls() {
  const SensorLattice& l = lattice_;
  const auto node = [&](int a, int b, int c) {
    return static_cast<std::size_t>((c * l.ny + b) * l.nx + a);
  };
  for (int c = 0; c < l.nz; ++c) {
    for (int b = 0; b < l.ny; ++b) {
      for (int a = 0; a < l.nx; ++a) {
        if (!in_wall_[node(a, b, c)]) continue;
        float* out = table_.data() + row(a, b, c);
        int count = 0;
        for (int z = std::max(c - 1, 0); z <= std::min(c + 1, l.nz - 1); ++z) {
          for (int y = std::max(b - 1, 0); y <= std::min(b + 1, l.ny - 1); ++y) {
            for (int x = std::max(a - 1, 0); x <= std::min(a + 1, l.nx - 1); ++x) {
              if (in_wall_[node(x, y, z)]) continue;
              ++count;
              const float* from = table_.data() + row(x, y, z);
              for (int i = 0; i < stride_; ++i) out[i] += from[i];
            }
          }
        }
        if (count > 1) {
          // Division may round a mean of ones above 1; the bound is part of the contract.
          for (int i = 0; i < stride_; ++i)
            out[i] = std::min(out[i] / static_cast<float>(count), 1.0f);
        }
      }
    }
  }
}

template <class Add>
void OcclusionTable::for_planes(const Eigen::Vector3d& sensor, const Add& add) const {
  const Eigen::Vector3d local = sensor - lattice_.origin;
  const Weights x = spline_weights(local.x(), lattice_.spacing, lattice_.nx);
  const Weights y = spline_weights(local.y(), lattice_.spacing, lattice_.ny);
  const Weights z = spline_weights(local.z(), lattice_.spacing, lattice_.nz);
  OcclusionPlane plane;
  std::copy_n(x.w.data(), 3, plane.x);
  std::copy_n(y.w.data(), 3, plane.y);
  std::copy_n(x.d.data(), 3, plane.dx);
  std::copy_n(y.d.data(), 3, plane.dy);
  for (int c = 0; c < z.count; ++c) {
    plane.z = z.w[static_cast<std::size_t>(c)];
    plane.dz = z.d[static_cast<std::size_t>(c)];
    for (int b = 0; b < 3; ++b) {
      for (int a = 0; a < 3; ++a) {
        plane.rows[b * 3 + a] = table_.data() + row(x.first + a, y.first + b, z.first + c);
      }
    }
    add(plane, c == 0);
  }
}

void OcclusionTable::evaluate(const Eigen::Vector3d& sensor, double* probability, double* d_x,
                              double* d_y, double* d_z) const {
  const int n = num_points();
  const bool gradient = d_x && d_y;
  if (!sensor.allFinite()) {
    for (double* out : {probability, d_x, d_y, d_z}) {
      if (out) std::fill_n(out, n, std::numeric_limits<double>::quiet_NaN());
    }
    return;
  }
  const bool vertical = lattice_.nz > 1;
  if (d_z && !vertical) std::fill_n(d_z, n, 0.0);
  for_planes(sensor, [&](const OcclusionPlane& plane, bool first) {
    kernel_(plane, n, first, probability, gradient ? d_x : nullptr, d_y,
            gradient && vertical ? d_z : nullptr);
  });
}

void OcclusionTable::score(const Eigen::Vector3d& sensor, float* probability) const {
  const int n = num_points();
  if (!sensor.allFinite()) {
    std::fill_n(probability, n, std::numeric_limits<float>::quiet_NaN());
    return;
  }
  for_planes(sensor, [&](const OcclusionPlane& plane, bool first) {
    score_kernel_(plane, n, first, probability);
  });
}

}  // namespace prospect

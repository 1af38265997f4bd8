// SPDX-License-Identifier: Apache-2.0
#include "engine/features/occlusion_table.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
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
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): s > 0, and lround() is a call
  const int center = std::min(static_cast<int>(s + 0.5), nodes - 2);
  const double f = s - center;
  r.first = center - 1;
  r.w = {0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)};
  if (raw > low && raw < high) r.d = {(f - 0.5) / spacing, -2.0 * f / spacing, (f + 0.5) / spacing};
  return r;
}

/// Along an axis, the lattice's nodes from `first` to `last`, by address in the world.
struct Nodes {
  double first, last;
};

// One node beyond the outermost position on either side: the spline's support is 1.5 spacings.
Nodes nodes_around(double center, double reach, double spacing) {
  return {std::floor((center - reach) / spacing) - 1.0,
          std::ceil((center + reach) / spacing) + 1.0};
}

/// Those of them within `range` of [low, high], and some more: a node within a wall takes its
/// neighbours' views, and the outermost positions are three nodes' affair. Three nodes at least.
Nodes within(const Nodes& all, double low, double high, double range, double spacing) {
  constexpr double kMore = 6.0, kLeast = 2.0;
  const double first = std::clamp(std::floor((low - range) / spacing) - kMore, all.first,
                                  std::max(all.first, all.last - kLeast));
  const double last = std::clamp(std::ceil((high + range) / spacing) + kMore, first + kLeast,
                                 std::max(first + kLeast, all.last));
  return {first, last};
}

/// 0 to count - 1, the nearest to the middle first.
std::vector<int> from_the_middle(int count) {
  std::vector<int> order(static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) {
    order[static_cast<std::size_t>(n)] = count / 2 + (n % 2 == 0 ? n / 2 : -(n + 1) / 2);
  }
  return order;
}

void set_axis(const Nodes& nodes, double spacing, double& origin, int& count) {
  constexpr double kMost = 1e9;
  origin = nodes.first * spacing;
  count = static_cast<int>(std::min(nodes.last - nodes.first, kMost)) + 1;
}

}  // namespace

SensorLattice SensorLattice::around(const Eigen::Vector3d& center, double reach, double spacing,
                                    bool vertical) {
  SensorLattice l;
  l.spacing = spacing;
  set_axis(nodes_around(center.x(), reach, spacing), spacing, l.origin.x(), l.nx);
  set_axis(nodes_around(center.y(), reach, spacing), spacing, l.origin.y(), l.ny);
  l.origin.z() = center.z();
  if (vertical) set_axis(nodes_around(center.z(), reach, spacing), spacing, l.origin.z(), l.nz);
  return l;
}

SensorLattice SensorLattice::around(const Eigen::Vector3d& center, double reach, double spacing,
                                    bool vertical, const std::vector<Eigen::Vector3d>& points,
                                    double range) {
  const auto fits = [&](const SensorLattice& l) {
    return static_cast<double>(l.nx) * l.ny * l.nz * static_cast<double>(points.size() + 8) <=
           kMostEntries;
  };
  SensorLattice l = around(center, reach, spacing, vertical);
  if (fits(l)) return l;
  Eigen::Vector3d low = center, high = center;
  if (!points.empty()) low = high = points.front();
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto axis = [&](int a, double& origin, int& count) {
    set_axis(within(nodes_around(center[a], reach, l.spacing), low[a], high[a], range, l.spacing),
             l.spacing, origin, count);
  };
  constexpr int kDoublings = 60;
  for (int n = 0; n < kDoublings; ++n, l.spacing *= 2.0) {
    axis(0, l.origin.x(), l.nx);
    axis(1, l.origin.y(), l.ny);
    if (vertical) axis(2, l.origin.z(), l.nz);
    if (fits(l)) break;
  }
  return l;
}

OcclusionTable::OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                               const VoxelGrid& voxels, const Options& options)
    : lattice_(lattice), points_(std::move(points)), options_(options) {
  prepare(voxels, nullptr, Clock::time_point::max());
  cast_all();
  cast_in_ = nullptr;
}

OcclusionTable::OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                               std::shared_ptr<const VoxelGrid> voxels, const Options& options,
                               const OcclusionTable* previous, Clock::time_point until)
    : lattice_(lattice), points_(std::move(points)), options_(options), voxels_(std::move(voxels)) {
  if (!voxels_) throw std::invalid_argument("occlusion table: voxels is null; expected a snapshot");
  prepare(*voxels_, previous, until);
}

void OcclusionTable::Unmap::operator()(float* memory) const { munmap(memory, bytes); }

double OcclusionTable::coordinate(int axis, int n) const {
  const double address = std::round(lattice_.origin[axis] / lattice_.spacing);
  const double aligned = address * lattice_.spacing;
  if (std::abs(aligned - lattice_.origin[axis]) < 1e-9 && (axis < 2 || lattice_.nz > 1)) {
    return (address + n) * lattice_.spacing;
  }
  return lattice_.origin[axis] + n * lattice_.spacing;
}

void OcclusionTable::prepare(const VoxelGrid& voxels, const OcclusionTable* previous,
                             Clock::time_point until) {
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
  if (static_cast<double>(l.nx) * l.ny * l.nz > kMostNodes) {
    throw std::invalid_argument("occlusion table: lattice of " + std::to_string(l.nx) + " x " +
                                std::to_string(l.ny) + " x " + std::to_string(l.nz) +
                                " nodes; expected at most " + std::to_string(kMostNodes));
  }
  for (const Eigen::Vector3d& p : points_) {
    if (!p.allFinite()) {
      throw std::invalid_argument("occlusion table: a point is not finite; expected [m] in W");
    }
  }
  cast_in_ = &voxels;
  stride_ = (num_points() + kPadding - 1) / kPadding * kPadding;
  const std::size_t nodes = static_cast<std::size_t>(l.nx) * static_cast<std::size_t>(l.ny) *
                            static_cast<std::size_t>(l.nz);
  const std::size_t bytes =
      std::max<std::size_t>(nodes * static_cast<std::size_t>(stride_), 1) * sizeof(float);
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  table_ = {static_cast<float*>(memory), Unmap{bytes}};
  // Its entries are kEmpty, which is zero.
  rows_ = std::make_unique<std::atomic<Row>[]>(nodes);
  for (int axis = 0; axis < 3; ++axis) {
    const int count = axis == 0 ? l.nx : axis == 1 ? l.ny : l.nz;
    for (int n = 0; n < count; ++n) {
      coordinates_[static_cast<std::size_t>(axis)].push_back(coordinate(axis, n));
    }
  }

  // Rays of one node are cast in the order of the points' distance from the lattice's middle, so
  // that rays abreast have similar lengths.
  const Eigen::Vector3d middle =
      0.5 * (node_position(0, 0, 0) + node_position(l.nx - 1, l.ny - 1, l.nz - 1));
  order_.resize(points_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) {
    return (points_[static_cast<std::size_t>(i)] - middle).squaredNorm() <
           (points_[static_cast<std::size_t>(j)] - middle).squaredNorm();
  });
  if (previous && previous->voxels_ && previous->options_ == options_ &&
      previous->lattice_.spacing == l.spacing &&
      previous->voxels_->resolution() == voxels.resolution()) {
    take_over(voxels, *previous, until);
  }
}

void OcclusionTable::take_over(const VoxelGrid& voxels, const OcclusionTable& previous,
                               Clock::time_point until) {
  const SensorLattice& l = lattice_;
  const SensorLattice& o = previous.lattice_;
  const Eigen::Vector3i shift = ((l.origin - o.origin) / l.spacing).array().round().cast<int>();
  for (int axis = 0; axis < 3; ++axis) {
    if (coordinate(axis, 0) != previous.coordinate(axis, shift[axis])) return;
  }

  // The old column of each point; -1: none.
  std::unordered_map<std::array<double, 3>, int, PositionHash> columns;
  columns.reserve(previous.points_.size());
  for (int i = 0; i < previous.num_points(); ++i) {
    columns.emplace(key(previous.points_[static_cast<std::size_t>(i)]), i);
  }
  std::vector<int> old_column(points_.size(), -1);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (const auto it = columns.find(key(points_[i])); it != columns.end()) {
      old_column[i] = it->second;
    }
  }

  std::unique_ptr<ChangedTiles> changed;
  if (previous.voxels_.get() != &voxels) {
    Eigen::Vector3d low = node_position(0, 0, 0);
    Eigen::Vector3d high = node_position(l.nx - 1, l.ny - 1, l.nz - 1);
    const Eigen::Vector3d farthest_low = low.array() - options_.max_range;
    const Eigen::Vector3d farthest_high = high.array() + options_.max_range;
    for (const Eigen::Vector3d& p : points_) {
      low = low.cwiseMin(p.cwiseMax(farthest_low));
      high = high.cwiseMax(p.cwiseMin(farthest_high));
    }
    const Eigen::Vector3i lo = voxels.voxel(low), hi = voxels.voxel(high);
    changed = std::make_unique<ChangedTiles>(voxels, *previous.voxels_, Cell{lo.x(), lo.y()},
                                             Cell{hi.x(), hi.y()});
    if (!changed->any()) changed.reset();
  }
  std::vector<Cell> point_tile(points_.size());
  if (changed) {
    for (std::size_t i = 0; i < points_.size(); ++i) point_tile[i] = changed->tile_at(points_[i]);
  }

  const bool all_of_them = until == Clock::time_point::max();
  const std::vector<int> layers = from_the_middle(l.nz), lines = from_the_middle(l.ny);
  for (const int c : layers) {
    const int oc = c + shift.z();
    if (oc < 0 || oc >= o.nz) continue;
    for (const int b : lines) {
      const int ob = b + shift.y();
      if (ob < 0 || ob >= o.ny) continue;
      for (int a = std::max(0, -shift.x()); a < std::min(l.nx, o.nx - shift.x()); ++a) {
        const int oa = a + shift.x();
        if (previous.rows_[previous.node(oa, ob, oc)].load(std::memory_order_acquire) !=
                Row::kReady ||
            in_wall(a, b, c, voxels) || previous.in_wall(oa, ob, oc, *previous.voxels_)) {
          continue;
        }
        if (!all_of_them && Clock::now() >= until) return;
        const float* old_row = previous.table_.get() + previous.row(oa, ob, oc);
        float* out = table_.get() + row(a, b, c);
        const Eigen::Vector3d from = node_position(a, b, c);
        const Cell here = changed ? changed->tile_at(from) : Cell();
        bool all = true;
        for (std::size_t i = 0; i < points_.size(); ++i) {
          const bool known = old_column[i] >= 0 &&
                             !(changed && changed->any(from, here, points_[i], point_tile[i]));
          out[i] = known ? old_row[old_column[i]] : std::numeric_limits<float>::quiet_NaN();
          all = all && known;
        }
        rows_[node(a, b, c)].store(all ? Row::kReady : Row::kPartial, std::memory_order_release);
      }
    }
  }
}

void OcclusionTable::cast_all() const {
  for (int c = 0; c < lattice_.nz; ++c) {
    for (int b = 0; b < lattice_.ny; ++b) {
      for (int a = 0; a < lattice_.nx; ++a) complete_row(a, b, c);
    }
  }
}

void OcclusionTable::complete(int a, int b, int c) const {
  std::atomic<Row>& state = rows_[node(a, b, c)];
  for (Row seen = state.load(std::memory_order_acquire); seen != Row::kReady;) {
    if (seen == Row::kBusy) {
      std::this_thread::yield();
      seen = state.load(std::memory_order_acquire);
      continue;
    }
    // A failed exchange says what is there now.
    if (!state.compare_exchange_weak(seen, Row::kBusy, std::memory_order_acquire)) continue;
    if (in_wall(a, b, c, *cast_in_)) {
      mean_of_neighbours(a, b, c);
    } else {
      cast_rays(a, b, c, seen == Row::kPartial);
    }
    state.store(Row::kReady, std::memory_order_release);
    return;
  }
}

void OcclusionTable::cast_rays(int a, int b, int c, bool partial) const {
  constexpr std::size_t kAtOnce = 64;
  std::array<int, kAtOnce> wanted;
  std::array<Eigen::Vector3d, kAtOnce> ends;
  std::array<VoxelGrid::Ray, kAtOnce> rays;
  std::size_t count = 0;
  const Eigen::Vector3d from = node_position(a, b, c);
  ends.fill(from);
  float* out = table_.get() + row(a, b, c);
  const auto cast = [&] {
    cast_in_->cast_many(from, ends.data(), static_cast<int>(count), options_.trim, rays.data());
    for (std::size_t n = 0; n < count; ++n) {
      const VoxelGrid::Ray& ray = rays[n];
      out[wanted[n]] =
          ray.blocked ? 0.0f
          : ray.unknown_length > 0.0
              ? static_cast<float>(std::exp(-options_.attenuation * ray.unknown_length))
              : 1.0f;
    }
    rays_cast_.fetch_add(static_cast<std::int64_t>(count), std::memory_order_relaxed);
    count = 0;
  };
  const double max_squared = options_.max_range * options_.max_range;
  for (const int n : order_) {
    const auto i = static_cast<std::size_t>(n);
    if (partial && !std::isnan(out[i])) continue;
    if ((points_[i] - from).squaredNorm() > max_squared) {
      out[i] = 0.0f;
      continue;
    }
    wanted[count] = n;
    ends[count] = points_[i];
    if (++count == kAtOnce) cast();
  }
  cast();
}

// Its neighbours in walls are left out, so that no row waits for a row that waits for it.
void OcclusionTable::mean_of_neighbours(int a, int b, int c) const {
  const SensorLattice& l = lattice_;
  float* out = table_.get() + row(a, b, c);
  int count = 0;
  for (int z = std::max(c - 1, 0); z <= std::min(c + 1, l.nz - 1); ++z) {
    for (int y = std::max(b - 1, 0); y <= std::min(b + 1, l.ny - 1); ++y) {
      for (int x = std::max(a - 1, 0); x <= std::min(a + 1, l.nx - 1); ++x) {
        if (in_wall(x, y, z, *cast_in_)) continue;
        ++count;
        const float* from = complete_row(x, y, z);
        for (int i = 0; i < stride_; ++i) out[i] += from[i];
      }
    }
  }
  if (count > 1) {
    // Division may round a mean of ones above 1; the bound is part of the contract.
    for (int i = 0; i < stride_; ++i) {
      out[i] = std::min(out[i] / static_cast<float>(count), 1.0f);
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
        plane.rows[b * 3 + a] = complete_row(x.first + a, y.first + b, z.first + c);
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

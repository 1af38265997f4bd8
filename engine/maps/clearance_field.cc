// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/clearance_field.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace prospect {
namespace {

// Squared gaps are counted in half voxels. Up to this halo they are kept in 16 bits, eight to a
// vector register: far_gap + (2 halo - 1)^2 must not overflow.
constexpr int kShortHalo = 50;
template <typename T>
constexpr T far_gap = 1'000'000'000;
template <>
constexpr std::int16_t far_gap<std::int16_t> = 20000;
constexpr double kMostReach = 1e8;  // [voxels]: so that addresses are integers
// Rings of nodes beyond the reach: two for the spline's support and the correction's stencil.
constexpr int kRing = 2;

/// Squared gap, in half voxels, between a voxel's centre and the voxel `a` further along one axis.
int squared_gap(int a) {
  const int gap = std::max(0, 2 * std::abs(a) - 1);
  return gap * gap;
}

/// [first, end) cut to what [low, high] touches of it; where they do not meet, the one entry of it
/// that is nearest.
void cut(int& first, int& count, std::int64_t low, std::int64_t high) {
  const std::int64_t last = std::int64_t{first} + count - 1;
  const std::int64_t from = std::clamp<std::int64_t>(low, first, last);
  count = static_cast<int>(std::clamp(high, from, last) - from + 1);
  first = static_cast<int>(from);
}

void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument("clearance field: " + message);
}

}  // namespace

ClearanceField::ClearanceField(const Eigen::Vector3d& center, const VoxelGrid& voxels,
                               const GroundMap& ground, const Options& options,
                               const ClearanceField* previous, const PausePoint& pause)
    : options_(options) {
  const double r = voxels.resolution();
  require(center.allFinite() && center.cwiseAbs().maxCoeff() < 1e6,
          "the centre is not finite or beyond 1000 km; expected one within");
  require(options.reach > 0.0 && std::isfinite(options.reach),
          "reach is " + std::to_string(options.reach) + " m; expected a finite one above 0");
  require(reaches(options.cutoff, r, options.vertical),
          "cutoff is " + std::to_string(options.cutoff) + " m; expected between 1 and " +
              std::to_string(options.vertical ? kMostVoxelsInSpace : kMostVoxels) + " voxels of " +
              std::to_string(r) + " m");
  require(std::isfinite(options.margin), "margin is not finite; expected a finite number");
  require(ground.frame().resolution == r,
          "ground map and voxels differ in resolution; expected the same");
  if (options.vertical) {
    require(options.vertical_reach > 0.0 && options.vertical_reach / r < 500.0,
            "vertical_reach is " + std::to_string(options.vertical_reach) +
                " m; expected within (0, 500 voxels)");
  } else {
    require(std::isfinite(options.slice.z_min) && std::isfinite(options.slice.z_max) &&
                options.slice.z_max > options.slice.z_min,
            "slice is [" + std::to_string(options.slice.z_min) + ", " +
                std::to_string(options.slice.z_max) + "] m; expected z_min < z_max");
  }

  halo_ = static_cast<int>(std::floor(options.cutoff / r + 0.5));
  // Along an axis: the lowest node of a window, and how many there are.
  const auto span = [r](double c, double reach) {
    const int lowest = static_cast<int>(std::floor((c - reach) / r)) - kRing;
    return std::pair(lowest, static_cast<int>(std::floor((c + reach) / r)) + kRing + 1 - lowest);
  };
  if (options.vertical) std::tie(k0_, depth_) = span(center.z(), options.vertical_reach);
  const auto place = [&](double reach) {
    window_.resolution = r;
    std::tie(window_.i0, window_.width) = span(center.x(), reach);
    std::tie(window_.j0, window_.height) = span(center.y(), reach);
    nodes_ = stored_part(voxels, ground);
  };
  place(std::min(options.reach, kMostReach * r));
  if (double{1} * nodes_.width * nodes_.height * depth_ > kMostNodes) {
    place(r * (0.5 * std::sqrt(kMostNodes / static_cast<double>(depth_)) - kRing - 1.0));
  }
  cells_ = nodes_;
  cells_.i0 -= halo_;
  cells_.j0 -= halo_;
  cells_.width += 2 * halo_;
  cells_.height += 2 * halo_;
  if (options.vertical) {
    cells_k0_ = k0_ - halo_;
    cells_depth_ = depth_ + 2 * halo_;
  }

  gather(voxels, ground, pause);
  if (previous != nullptr && previous->resolution() == r &&
      previous->options_.cutoff == options.cutoff &&
      previous->options_.vertical == options.vertical) {
    offset_distance_ = previous->offset_distance_;
  } else {
    measure_offsets(pause);
  }
  if (halo_ <= kShortHalo) {
    transform<std::int16_t>(pause);
  } else {
    transform<std::int32_t>(pause);
  }
  if (options.zones != nullptr && options.zones->num_forbidden() > 0) keep_out(pause);
  correct(pause);
}

GridFrame ClearanceField::stored_part(const VoxelGrid& voxels, const GroundMap& ground) const {
  std::int64_t low[2], high[2];
  const auto take = [&](const GridFrame& f) {
    low[0] = f.i0;
    low[1] = f.j0;
    high[0] = std::int64_t{f.i0} + f.width - 1;
    high[1] = std::int64_t{f.j0} + f.height - 1;
  };
  take(voxels.frame());
  const auto include = [&](int axis, std::int64_t from, std::int64_t to) {
    low[axis] = std::min(low[axis], from);
    high[axis] = std::max(high[axis], to);
  };
  const GridFrame& g = ground.frame();
  if (options_.obstacles == Obstacles::kOccupiedAndUnknown && !options_.vertical && g.size() > 0) {
    include(0, g.i0, std::int64_t{g.i0} + g.width - 1);
    include(1, g.j0, std::int64_t{g.j0} + g.height - 1);
  }
  if (options_.zones != nullptr && options_.zones->num_forbidden() > 0) {
    const auto [from, to] = options_.zones->forbidden_box();
    for (int axis = 0; axis < 2; ++axis) {
      include(axis, std::llround(from[axis] / window_.resolution) - 1,
              std::llround(to[axis] / window_.resolution) + 1);
    }
  }
  // Nodes farther than the halo are all alike, and so are the coefficients of those whose
  // neighbours are, too: the border's is that of all beyond.
  const int around = halo_ + 2;
  GridFrame part = window_;
  cut(part.i0, part.width, low[0] - around, high[0] + around);
  cut(part.j0, part.height, low[1] - around, high[1] + around);
  return part;
}

void ClearanceField::gather(const VoxelGrid& voxels, const GroundMap& ground,
                            const PausePoint& pause) {
  assign_in_pieces(solid_,
                   static_cast<std::size_t>(cells_.size()) * static_cast<std::size_t>(cells_depth_),
                   std::uint8_t{0}, pause);
  const bool unknown_counts = options_.obstacles == Obstacles::kOccupiedAndUnknown;
  const double r = cells_.resolution;
  const int grid_low = voxels.k0();
  const int grid_high = voxels.k0() + voxels.depth();  // exclusive
  std::uint8_t* column = solid_.data();
  if (options_.vertical) {
    const int low = std::clamp(cells_k0_, grid_low, grid_high);
    const int high = std::clamp(cells_k0_ + cells_depth_, low, grid_high);
    for (int n = 0; n < cells_.size(); ++n, column += cells_depth_) {
      if (n % 256 == 0) pause();
      const Cell c = cells_.at(n);
      if (unknown_counts) std::fill_n(column, cells_depth_, std::uint8_t{1});
      if (!voxels.frame().contains(c) || high == low) continue;
      const CellState* state = voxels.data().data() + voxels.index(c.i, c.j, low);
      for (int k = low; k < high; ++k, ++state) {
        column[k - cells_k0_] =
            *state == CellState::kOccupied || (unknown_counts && *state == CellState::kUnknown);
      }
    }
    return;
  }
  const double low_voxel = std::floor(options_.slice.z_min / r + kFaceTolerance);
  const double high_voxel = std::ceil(options_.slice.z_max / r - kFaceTolerance);
  const int low = static_cast<int>(std::clamp<double>(low_voxel, grid_low, grid_high));
  const int high = static_cast<int>(std::clamp<double>(high_voxel, low, grid_high));
  for (int n = 0; n < cells_.size(); ++n, ++column) {
    if (n % 1024 == 0) pause();
    const Cell c = cells_.at(n);
    // The ground map knows besides where there is no floor.
    const CellState cell = ground.state(c);
    bool solid = cell == CellState::kOccupied || (unknown_counts && cell == CellState::kUnknown);
    if (!solid && high > low && voxels.frame().contains(c)) {
      const CellState* state = voxels.data().data() + voxels.index(c.i, c.j, low);
      solid = std::find(state, state + (high - low), CellState::kOccupied) != state + (high - low);
    }
    *column = solid;
  }
}

void ClearanceField::measure_offsets(const PausePoint& pause) {
  const double r = nodes_.resolution;
  const double steps = 2.0 * options_.cutoff / r;
  offset_distance_.assign(static_cast<std::size_t>(std::floor(steps * steps)) + 1,
                          std::numeric_limits<double>::quiet_NaN());
  // A voxel that overlaps the slice overlaps the planar probe's height, so the segment's distance
  // to it is that of the point at the voxel's height: one probe, a sphere of radius zero, does for
  // both.
  const fcl::Sphered probe(0.0);
  const fcl::Boxd voxel(r, r, r);
  const fcl::Transform3d at_origin = fcl::Transform3d::Identity();
  fcl::Transform3d at_offset = fcl::Transform3d::Identity();
  const fcl::DistanceRequestd request;
  const int highest = options_.vertical ? halo_ : 0;
  for (int a = 1; a <= halo_; ++a) {
    for (int b = 0; b <= a; ++b) {
      for (int c = 0; c <= std::min(b, highest); ++c) {
        const std::size_t q =
            static_cast<std::size_t>(squared_gap(a) + squared_gap(b) + squared_gap(c));
        if (q >= offset_distance_.size() || !std::isnan(offset_distance_[q])) continue;
        pause();
        at_offset.translation() = r * Eigen::Vector3d(a, b, c);
        fcl::DistanceResultd result;
        fcl::distance(&probe, at_origin, &voxel, at_offset, request, result);
        offset_distance_[q] = std::min(result.min_distance, options_.cutoff);
      }
    }
  }
}

template <typename T>
void ClearanceField::transform(const PausePoint& pause) {
  constexpr T kFar = far_gap<T>;
  const int M = halo_;
  const int D = depth_;
  const std::size_t node_row = static_cast<std::size_t>(nodes_.width) * static_cast<std::size_t>(D);
  const std::size_t wide_row = static_cast<std::size_t>(cells_.width) * static_cast<std::size_t>(D);
  const std::size_t shift = static_cast<std::size_t>(D);  // one voxel along x
  assign_in_pieces(values_, static_cast<std::size_t>(nodes_.size()) * static_cast<std::size_t>(D),
                   0.0, pause);
  std::vector<T> along_z(wide_row), below(static_cast<std::size_t>(cells_depth_));
  std::vector<T> along_x;
  assign_in_pieces(along_x, node_row * static_cast<std::size_t>(cells_.height), T{0}, pause);
  std::vector<T> nearest(node_row);
  std::vector<T> gap2(static_cast<std::size_t>(M) + 1);
  for (int a = 0; a <= M; ++a) gap2[static_cast<std::size_t>(a)] = static_cast<T>(squared_gap(a));

  // Separable exact transform: the squared gap to the nearest voxel of the wanted kind is a minimum
  // over x of (a minimum over y of (a minimum over z)). First to solid voxels, for nodes outside;
  // then to free ones, for nodes inside.
  for (const std::uint8_t wanted : {std::uint8_t{1}, std::uint8_t{0}}) {
    for (int j = 0; j < cells_.height; ++j) {
      pause();
      const std::uint8_t* solid =
          solid_.data() + static_cast<std::ptrdiff_t>(j) * cells_.width * cells_depth_;
      if (cells_depth_ == 1) {
        for (std::size_t n = 0; n < wide_row; ++n) {
          along_z[n] = solid[n] == wanted ? T{0} : kFar;
        }
      } else {
        for (int i = 0; i < cells_.width; ++i, solid += cells_depth_) {
          T* out = along_z.data() + static_cast<std::ptrdiff_t>(i) * D;
          // Most columns are of one kind throughout.
          const auto depth = static_cast<std::size_t>(cells_depth_);
          if (std::memchr(solid, wanted, depth) == nullptr) {
            std::fill_n(out, D, kFar);
            continue;
          }
          if (std::memchr(solid, 1 - wanted, depth) == nullptr) {
            std::fill_n(out, D, T{0});
            continue;
          }
          int last = -2 * M;
          for (int k = 0; k < cells_depth_; ++k) {
            if (solid[k] == wanted) last = k;
            below[static_cast<std::size_t>(k)] = static_cast<T>(std::min(k - last, M + 1));
          }
          int next = cells_depth_ + 2 * M;
          for (int k = cells_depth_ - 1; k >= M; --k) {
            if (solid[k] == wanted) next = k;
            if (k >= M + D) continue;
            const int steps = std::min<int>(below[static_cast<std::size_t>(k)], next - k);
            out[k - M] = steps > M ? kFar : gap2[static_cast<std::size_t>(steps)];
          }
        }
      }
      T* out = along_x.data() + static_cast<std::size_t>(j) * node_row;
      std::fill_n(out, node_row, kFar);
      for (int a = -M; a <= M; ++a) {
        const T add = gap2[static_cast<std::size_t>(std::abs(a))];
        const T* in = along_z.data() + static_cast<std::size_t>(M + a) * shift;
        for (std::size_t n = 0; n < node_row; ++n) {
          const auto sum = static_cast<T>(in[n] + add);
          out[n] = std::min(out[n], sum);
        }
      }
    }
    const double sign = wanted == 1 ? 1.0 : -1.0;
    const double far = sign * options_.cutoff;
    for (int j = 0; j < nodes_.height; ++j) {
      pause();
      std::fill(nearest.begin(), nearest.end(), kFar);
      for (int b = -M; b <= M; ++b) {
        const T add = gap2[static_cast<std::size_t>(std::abs(b))];
        const T* in = along_x.data() + static_cast<std::size_t>(j + M + b) * node_row;
        for (std::size_t n = 0; n < node_row; ++n) {
          const auto sum = static_cast<T>(in[n] + add);
          nearest[n] = std::min(nearest[n], sum);
        }
      }
      double* value = values_.data() + static_cast<std::size_t>(j) * node_row;
      for (std::size_t n = 0; n < node_row; ++n) {
        const auto q = static_cast<std::size_t>(nearest[n]);
        if (q == 0) continue;  // the node itself is of the wanted kind: the other sweep's business
        value[n] = q < offset_distance_.size() ? sign * offset_distance_[q] : far;
      }
    }
  }
}

void ClearanceField::keep_out(const PausePoint& pause) {
  double* value = values_.data();
  for (int n = 0; n < nodes_.size(); ++n) {
    if (n % 64 == 0) pause();
    const double distance = std::clamp(options_.zones->distance(nodes_.center(nodes_.at(n))),
                                       -options_.cutoff, options_.cutoff);
    for (int k = 0; k < depth_; ++k, ++value) *value = std::min(*value, distance);
  }
}

void ClearanceField::correct(const PausePoint& pause) {
  assign_in_pieces(coefficients_, values_.size(), 0.0, pause);
  const std::ptrdiff_t D = depth_;
  const std::ptrdiff_t step_i = D;
  const std::ptrdiff_t step_j = D * nodes_.width;
  const double* f = values_.data();
  double* c = coefficients_.data();
  const auto convexity = [](double low, double at, double high) {
    return std::max(0.0, low - 2.0 * at + high);
  };
  for (int j = 0; j < nodes_.height; ++j) {
    pause();
    for (int i = 0; i < nodes_.width; ++i, f += D, c += D) {
      // Beyond the border f continues as a constant: a missing neighbour is the node itself.
      const double* left = i > 0 ? f - step_i : f;
      const double* right = i + 1 < nodes_.width ? f + step_i : f;
      const double* front = j > 0 ? f - step_j : f;
      const double* back = j + 1 < nodes_.height ? f + step_j : f;
      for (std::ptrdiff_t k = 0; k < D; ++k) {
        c[k] = f[k] - options_.margin -
               0.125 * (convexity(left[k], f[k], right[k]) + convexity(front[k], f[k], back[k]));
      }
      if (D == 1) continue;
      c[0] -= 0.125 * convexity(f[0], f[0], f[1]);
      for (std::ptrdiff_t k = 1; k + 1 < D; ++k) {
        c[k] -= 0.125 * convexity(f[k - 1], f[k], f[k + 1]);
      }
      c[D - 1] -= 0.125 * convexity(f[D - 2], f[D - 1], f[D - 1]);
    }
  }
}

template <bool kGradient>
double ClearanceField::interpolate(const Eigen::Vector3d& p, Eigen::Vector3d* gradient) const {
  const int dimensions = depth_ == 1 ? 2 : 3;
  if (!p.head(dimensions).allFinite()) {
    if constexpr (kGradient) gradient->setZero();
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double r = nodes_.resolution;
  const int low[3] = {window_.i0, window_.j0, k0_};
  const int size[3] = {window_.width, window_.height, depth_};
  // Of the window, what is stored; beyond it all is as at its border.
  const int skipped[3] = {nodes_.i0 - window_.i0, nodes_.j0 - window_.j0, 0};
  const int stored[3] = {nodes_.width, nodes_.height, depth_};
  const std::ptrdiff_t stride[3] = {depth_, static_cast<std::ptrdiff_t>(depth_) * nodes_.width, 1};
  std::ptrdiff_t offset[3][3];
  double weight[3][3], slope[3][3];
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  bool outside = false;
  for (int a = 0; a < dimensions; ++a) {
    // In units of voxels from the lattice's lowest face; nodes at 1/2, 3/2, ... The end nodes are
    // repeated outward, so the spline is constant from the faces on, with zero slope there.
    const double u = p[a] / r - low[a];
    const double inside = std::clamp(u, 0.0, static_cast<double>(size[a]));
    if (u != inside) {
      beyond[a] = p[a] - (low[a] + inside) * r;
      outside = true;
    }
    const int base = std::min(static_cast<int>(inside), size[a] - 1);
    const double t = inside - base - 0.5;
    weight[a][0] = 0.5 * (0.5 - t) * (0.5 - t);
    weight[a][1] = 0.75 - t * t;
    weight[a][2] = 0.5 * (0.5 + t) * (0.5 + t);
    slope[a][0] = t - 0.5;
    slope[a][1] = -2.0 * t;
    slope[a][2] = t + 0.5;
    for (int n = 0; n < 3; ++n) {
      offset[a][n] = std::clamp(base + n - 1 - skipped[a], 0, stored[a] - 1) * stride[a];
    }
  }

  double value = 0.0;
  double d[3] = {0.0, 0.0, 0.0};
  const double* c = coefficients_.data();
  if (dimensions == 2) {
    for (int n = 0; n < 3; ++n) {
      const double* row = c + offset[1][n];
      const double c0 = row[offset[0][0]], c1 = row[offset[0][1]], c2 = row[offset[0][2]];
      const double sum = weight[0][0] * c0 + weight[0][1] * c1 + weight[0][2] * c2;
      value += weight[1][n] * sum;
      if constexpr (!kGradient) continue;
      d[0] += weight[1][n] * (slope[0][0] * c0 + slope[0][1] * c1 + slope[0][2] * c2);
      d[1] += slope[1][n] * sum;
    }
  } else {
    for (int n = 0; n < 3; ++n) {
      for (int m = 0; m < 3; ++m) {
        const double* line = c + offset[1][n] + offset[0][m];
        const double c0 = line[offset[2][0]], c1 = line[offset[2][1]], c2 = line[offset[2][2]];
        const double sum = weight[2][0] * c0 + weight[2][1] * c1 + weight[2][2] * c2;
        const double w = weight[1][n] * weight[0][m];
        value += w * sum;
        if constexpr (!kGradient) continue;
        d[0] += weight[1][n] * slope[0][m] * sum;
        d[1] += slope[1][n] * weight[0][m] * sum;
        d[2] += w * (slope[2][0] * c0 + slope[2][1] * c1 + slope[2][2] * c2);
      }
    }
  }
  Eigen::Vector3d g(d[0] / r, d[1] / r, d[2] / r);
  if (outside) {
    // hypot, so that far-away points cannot overflow.
    const double length = std::hypot(std::hypot(beyond.x(), beyond.y(), beyond.z()), r);
    value -= length - r;
    g -= beyond / length;
  }
  if constexpr (kGradient) *gradient = g;
  return value;
}

template double ClearanceField::interpolate<true>(const Eigen::Vector3d&, Eigen::Vector3d*) const;
template double ClearanceField::interpolate<false>(const Eigen::Vector3d&, Eigen::Vector3d*) const;

}  // namespace prospect

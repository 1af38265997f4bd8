// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#if defined(__x86_64__) && defined(__GNUC__)
#define PROSPECT_X86
#include <immintrin.h>
#endif

namespace prospect {

VoxelGrid::VoxelGrid(const GridFrame& frame, double z_min, double z_max) : frame_(frame) {
  k0_ = static_cast<int>(std::floor(z_min / frame.resolution));
  depth_ = std::max(1, static_cast<int>(std::ceil(z_max / frame.resolution)) - k0_);
  data_.assign(static_cast<std::size_t>(frame.size()) * static_cast<std::size_t>(depth_),
               CellState::kUnknown);
}

VoxelGrid::VoxelGrid(const GridFrame& frame, int k0, int depth, std::vector<CellState> data)
    : frame_(frame), k0_(k0), depth_(depth), data_(std::move(data)) {
  if (frame.width < 1 || frame.height < 1 || depth < 1 || !(frame.resolution > 0.0) ||
      data_.size() != static_cast<std::size_t>(frame.width) *
                          static_cast<std::size_t>(frame.height) *
                          static_cast<std::size_t>(depth)) {
    throw std::invalid_argument("voxel grid: " + std::to_string(data_.size()) + " states for " +
                                std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                                " x " + std::to_string(depth) +
                                " voxels; expected one each, at least one");
  }
}

void VoxelGrid::set(int i, int j, int k, CellState state) {
  if (k < k0_ || k >= k0_ + depth_) return;
  if (!frame_.contains({i, j})) {
    if (state == CellState::kUnknown) return;
    constexpr int kMargin = 128;
    const GridFrame old = frame_;
    GridFrame wide = old;
    wide.i0 = i < old.i0 ? i - kMargin : old.i0;
    wide.j0 = j < old.j0 ? j - kMargin : old.j0;
    wide.width = (i >= old.i0 + old.width ? i + kMargin : old.i0 + old.width) - wide.i0;
    wide.height = (j >= old.j0 + old.height ? j + kMargin : old.j0 + old.height) - wide.j0;
    std::vector<CellState> data(
        static_cast<std::size_t>(wide.size()) * static_cast<std::size_t>(depth_),
        CellState::kUnknown);
    const std::size_t row = static_cast<std::size_t>(old.width) * static_cast<std::size_t>(depth_);
    for (int y = 0; y < old.height; ++y) {
      std::copy_n(
          data_.begin() + static_cast<std::ptrdiff_t>(row) * y, row,
          data.begin() + static_cast<std::ptrdiff_t>(wide.index({old.i0, old.j0 + y})) * depth_);
    }
    frame_ = wide;
    data_ = std::move(data);
  }
  data_[index(i, j, k)] = state;
}

namespace {

int floor_to_int(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < truncated);
}

// State of a ray on its path through the voxels, after Amanatides and Woo, "A fast voxel traversal
// algorithm for ray tracing" (Eurographics 1987).
struct Traversal {
  int voxel[3];
  int step[3];
  double next[3];   // ray parameter [m] at the next voxel face
  double delta[3];  // and between faces
  double end = 0.0;

  // False if there is nothing to walk. `voxel` must hold the voxel of `from`.
  bool start(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double trim, double r) {
    const Eigen::Vector3d span = to - from;
    const double distance = std::sqrt(span.squaredNorm());
    end = distance - trim;
    if (!(end > 0.0) || !std::isfinite(distance)) return false;
    for (int a = 0; a < 3; ++a) {
      if (span[a] == 0.0) {
        step[a] = 0;
        next[a] = delta[a] = std::numeric_limits<double>::infinity();
        continue;
      }
      const double per_meter = distance / span[a];  // of ray, for each metre along the axis
      step[a] = span[a] > 0.0 ? 1 : -1;
      next[a] = ((voxel[a] + (span[a] > 0.0 ? 1 : 0)) * r - from[a]) * per_meter;
      delta[a] = r * std::abs(per_meter);
    }
    return true;
  }

  // Axis of the next face.
  int next_axis() const {
    const int axis = next[0] < next[1] ? 0 : 1;
    return next[2] < next[axis] ? 2 : axis;
  }
  // `faces` more of them along the axis.
  void pass(int axis, std::int64_t faces) {
    voxel[axis] += static_cast<int>(step[axis] * faces);
    next[axis] += static_cast<double>(faces) * delta[axis];
  }
  // From a voxel outside of the block [low, low + size) to the first one inside. Returns where that
  // is, ray parameter [m]; infinity: the ray does not get into it before `end`.
  double enter(const int (&low)[3], const int (&size)[3]) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    double entry = 0.0;
    std::int64_t faces[3] = {0, 0, 0};
    for (int a = 0; a < 3; ++a) {
      const std::int64_t below = std::int64_t{low[a]} - voxel[a];
      const std::int64_t above = std::int64_t{voxel[a]} - (std::int64_t{low[a]} + size[a] - 1);
      if (below <= 0 && above <= 0) continue;
      if (step[a] != (below > 0 ? 1 : -1)) return kNever;
      faces[a] = std::max(below, above);
      entry = std::max(entry, next[a] + static_cast<double>(faces[a] - 1) * delta[a]);
    }
    if (!(entry < end)) return kNever;
    for (int a = 0; a < 3; ++a) {
      if (next[a] < entry) {  // never along an axis that it keeps to
        const double passed = std::ceil((entry - next[a]) / delta[a]);
        faces[a] = std::max(faces[a], static_cast<std::int64_t>(passed));
      }
      const std::int64_t there = voxel[a] + step[a] * faces[a];
      if (there < low[a] || there >= std::int64_t{low[a]} + size[a]) return kNever;
    }
    for (int a = 0; a < 3; ++a) {
      if (faces[a] > 0) pass(a, faces[a]);
    }
    return entry;
  }
};

bool addressable(const Eigen::Vector3d& p) { return p.cwiseAbs().maxCoeff() < kFarthest; }

// Rays side by side through one block of voxels; every address that one can reach lies in the
// block, at least three voxels before its end (four bytes are read at once).
constexpr int kRays = 8;
struct Lanes {
  alignas(64) double next[3][kRays];
  alignas(64) double delta[3][kRays];
  alignas(64) std::int64_t stride[3][kRays];  // signed by the direction of travel
  alignas(64) std::int64_t address[kRays];
  alignas(64) double end[kRays];
  alignas(64) std::int64_t active[kRays];   // in: -1 walk, 0 idle
  alignas(64) std::int64_t blocked[kRays];  // out: -1 where an occupied voxel was met
  alignas(64) double walked[kRays];         // out: ray parameter at the last face [m]
  alignas(64) double unknown[kRays];        // out
};

// One ray at a time.
void walk_one_by_one(const CellState* data, Lanes& lanes) {
  for (int l = 0; l < kRays; ++l) {
    lanes.blocked[l] = 0;
    lanes.walked[l] = lanes.unknown[l] = 0.0;
    if (!lanes.active[l]) continue;
    double nx = lanes.next[0][l], ny = lanes.next[1][l], nz = lanes.next[2][l];
    const double dx = lanes.delta[0][l], dy = lanes.delta[1][l], dz = lanes.delta[2][l];
    const double end = lanes.end[l];
    const CellState* p = data + lanes.address[l];
    double t = 0.0, unknown = 0.0;
    bool counted = false;  // the voxel that holds `from` is not
    while (true) {
      double leave;
      std::int64_t move;
      if (nz < (nx < ny ? nx : ny)) {
        leave = nz, move = lanes.stride[2][l], nz += dz;
      } else if (nx < ny) {
        leave = nx, move = lanes.stride[0][l], nx += dx;
      } else {
        leave = ny, move = lanes.stride[1][l], ny += dy;
      }
      if (counted && *p != CellState::kFree) {
        if (*p == CellState::kOccupied) {
          lanes.blocked[l] = -1;
          break;
        }
        unknown += (leave < end ? leave : end) - t;
      }
      counted = true;
      if (!(leave < end)) break;
      t = leave;
      p += move;
    }
    lanes.walked[l] = t;
    lanes.unknown[l] = unknown;
  }
}

#ifdef PROSPECT_X86
// Eight rays abreast, in two groups of four that hide each other's latency. The same operations in
// the same order as above, hence the same bits. The common step, through a free voxel, only
// advances; voxels that are not free and rays that end are branched to.
__attribute__((target("avx2"))) void walk_abreast(const CellState* data, Lanes& lanes) {
  constexpr int kGroups = kRays / 4;
  constexpr std::uint32_t kAllFree = 0x01010101u * static_cast<std::uint32_t>(CellState::kFree);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(data);
  __m256d nx[kGroups], ny[kGroups], nz[kGroups], t[kGroups];
  __m256i address[kGroups];
  int walking[kGroups];            // bit l: lane l of the group walks on
  std::uint32_t watched[kGroups];  // byte l: 0xFF where lane l's voxel matters
  int left = 0;
  for (int g = 0; g < kGroups; ++g) {
    nx[g] = _mm256_load_pd(lanes.next[0] + 4 * g);
    ny[g] = _mm256_load_pd(lanes.next[1] + 4 * g);
    nz[g] = _mm256_load_pd(lanes.next[2] + 4 * g);
    t[g] = _mm256_setzero_pd();
    address[g] = _mm256_load_si256(reinterpret_cast<const __m256i*>(lanes.address + 4 * g));
    watched[g] = 0;  // the voxels that hold `from`
    walking[g] = 0;
    for (int l = 0; l < 4; ++l) {
      const int n = 4 * g + l;
      lanes.blocked[n] = 0;
      lanes.walked[n] = lanes.unknown[n] = 0.0;
      if (lanes.active[n]) walking[g] |= 1 << l;
    }
    left += walking[g];
  }
  bool first = true;
  while (left != 0) {
    for (int g = 0; g < kGroups; ++g) {
      const __m256d x_first = _mm256_cmp_pd(nx[g], ny[g], _CMP_LT_OQ);
      const __m256d xy = _mm256_min_pd(nx[g], ny[g]);
      const __m256d z_first = _mm256_cmp_pd(nz[g], xy, _CMP_LT_OQ);
      const __m256d leave = _mm256_min_pd(nz[g], xy);
      const __m128i low = _mm256_castsi256_si128(address[g]);
      const __m128i high = _mm256_extracti128_si256(address[g], 1);
      // Four plain loads: the gather instruction is slow on many machines.
      const std::uint32_t state =
          static_cast<std::uint32_t>(bytes[_mm_cvtsi128_si64(low)]) |
          static_cast<std::uint32_t>(bytes[_mm_extract_epi64(low, 1)]) << 8 |
          static_cast<std::uint32_t>(bytes[_mm_cvtsi128_si64(high)]) << 16 |
          static_cast<std::uint32_t>(bytes[_mm_extract_epi64(high, 1)]) << 24;
      const __m256d end = _mm256_load_pd(lanes.end + 4 * g);
      int stop = walking[g] & ~_mm256_movemask_pd(_mm256_cmp_pd(leave, end, _CMP_LT_OQ));
      if (((state ^ kAllFree) & watched[g]) != 0) {
        const __m256i kind = _mm256_cvtepu8_epi64(_mm_cvtsi32_si128(static_cast<int>(state)));
        const __m256i observed =
            _mm256_cvtepi8_epi64(_mm_cvtsi32_si128(static_cast<int>(watched[g])));
        const __m256d is_unknown = _mm256_castsi256_pd(_mm256_and_si256(
            observed,
            _mm256_cmpeq_epi64(kind, _mm256_set1_epi64x(static_cast<int>(CellState::kUnknown)))));
        const __m256d is_occupied = _mm256_castsi256_pd(_mm256_and_si256(
            observed,
            _mm256_cmpeq_epi64(kind, _mm256_set1_epi64x(static_cast<int>(CellState::kOccupied)))));
        const __m256d within = _mm256_sub_pd(_mm256_min_pd(leave, end), t[g]);
        _mm256_store_pd(lanes.unknown + 4 * g, _mm256_add_pd(_mm256_load_pd(lanes.unknown + 4 * g),
                                                             _mm256_and_pd(within, is_unknown)));
        const int hit = _mm256_movemask_pd(is_occupied);
        if (hit != 0) {
          alignas(32) double here[4];
          _mm256_store_pd(here, t[g]);
          for (int l = 0; l < 4; ++l) {
            if ((hit >> l & 1) == 0) continue;
            lanes.blocked[4 * g + l] = -1;
            lanes.walked[4 * g + l] = here[l];
          }
          stop |= hit;
        }
      }
      if (stop != 0) {
        for (int l = 0; l < 4; ++l) {
          if ((stop >> l & 1) == 0) continue;
          // A lane that is done stays where it is.
          for (auto& stride : lanes.stride) stride[4 * g + l] = 0;
          watched[g] &= ~(0xFFu << (8 * l));
        }
        left -= stop;
        walking[g] &= ~stop;
      }
      t[g] = leave;
      const __m256d along_x = _mm256_andnot_pd(z_first, x_first);
      const __m256d not_y = _mm256_or_pd(z_first, x_first);
      const auto stride = [&](int axis) __attribute__((target("avx2"), always_inline)) {
        return reinterpret_cast<const double*>(lanes.stride[axis] + 4 * g);
      };
      const __m256d move =
          _mm256_or_pd(_mm256_or_pd(_mm256_and_pd(_mm256_load_pd(stride(0)), along_x),
                                    _mm256_andnot_pd(not_y, _mm256_load_pd(stride(1)))),
                       _mm256_and_pd(_mm256_load_pd(stride(2)), z_first));
      address[g] = _mm256_add_epi64(address[g], _mm256_castpd_si256(move));
      nx[g] = _mm256_add_pd(nx[g], _mm256_and_pd(_mm256_load_pd(lanes.delta[0] + 4 * g), along_x));
      ny[g] = _mm256_add_pd(ny[g], _mm256_andnot_pd(not_y, _mm256_load_pd(lanes.delta[1] + 4 * g)));
      nz[g] = _mm256_add_pd(nz[g], _mm256_and_pd(_mm256_load_pd(lanes.delta[2] + 4 * g), z_first));
    }
    if (first) {
      first = false;
      for (int g = 0; g < kGroups; ++g) {
        for (int l = 0; l < 4; ++l) {
          if (walking[g] >> l & 1) watched[g] |= 0xFFu << (8 * l);
        }
      }
    }
  }
}
#endif

void walk(const CellState* data, Lanes& lanes) {
#ifdef PROSPECT_X86
  static const bool wide = __builtin_cpu_supports("avx2");
  if (wide) return walk_abreast(data, lanes);
#endif
  walk_one_by_one(data, lanes);
}

}  // namespace

VoxelGrid::Ray VoxelGrid::cast(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                               double trim) const {
  Ray ray;
  if (!addressable(from) || !addressable(to)) return ray;
  const double r = frame_.resolution;
  Traversal w;
  for (int a = 0; a < 3; ++a) w.voxel[a] = floor_to_int(from[a] / r);
  if (!w.start(from, to, trim, r)) return ray;
  ray.length = w.end;
  int axis = w.next_axis();
  double t = w.next[axis];  // the voxel that holds `from` is not counted
  if (!(t < w.end)) return ray;
  w.pass(axis, 1);
  if (!contains(w.voxel[0], w.voxel[1], w.voxel[2])) {
    const double entry =
        w.enter({frame_.i0, frame_.j0, k0_}, {frame_.width, frame_.height, depth_});
    ray.unknown_length = std::max(0.0, std::min(entry, w.end) - t);
    if (!(entry < w.end)) return ray;
    t = std::max(t, entry);
  }
  while (contains(w.voxel[0], w.voxel[1], w.voxel[2])) {
    axis = w.next_axis();
    const double leave = w.next[axis];
    const CellState s = data_[index(w.voxel[0], w.voxel[1], w.voxel[2])];
    if (s == CellState::kOccupied) {
      ray.blocked = true;
      ray.length = t;
      return ray;
    }
    if (s == CellState::kUnknown) ray.unknown_length += std::min(leave, w.end) - t;
    if (!(leave < w.end)) return ray;
    t = leave;
    w.pass(axis, 1);
  }
  ray.unknown_length += w.end - t;  // it does not come back
  return ray;
}

void VoxelGrid::cast_many(const Eigen::Vector3d& from, const Eigen::Vector3d* to, int count,
                          double trim, Ray* rays) const {
  const double r = frame_.resolution;
  const bool from_addressable = addressable(from);
  int start[3] = {0, 0, 0};
  if (from_addressable) {
    for (int a = 0; a < 3; ++a) start[a] = floor_to_int(from[a] / r);
  }
  const bool from_inside = from_addressable && contains(start[0], start[1], start[2]);
  const std::int64_t stride[3] = {depth_, static_cast<std::int64_t>(depth_) * frame_.width, 1};
  const std::int64_t here =
      from_inside ? static_cast<std::int64_t>(index(start[0], start[1], start[2])) : 0;
  Lanes lanes;
  int owner[kRays];
  int used = 0;
  const auto flush = [&] {
    if (used == 0) return;
    for (int l = used; l < kRays; ++l) {
      for (int a = 0; a < 3; ++a) {
        lanes.next[a][l] = lanes.delta[a][l] = 0.0;
        lanes.stride[a][l] = 0;
      }
      lanes.address[l] = here;
      lanes.end[l] = 0.0;
      lanes.active[l] = 0;
    }
    walk(data_.data(), lanes);
    for (int l = 0; l < used; ++l) {
      Ray& ray = rays[owner[l]];
      ray.blocked = lanes.blocked[l] != 0;
      ray.length = ray.blocked ? lanes.walked[l] : lanes.end[l];
      ray.unknown_length = lanes.unknown[l];
    }
    used = 0;
  };
  for (int i = 0; i < count; ++i) {
    Traversal w;
    bool inside = from_inside && addressable(to[i]);
    if (inside) {
      for (int a = 0; a < 3; ++a) w.voxel[a] = start[a];
      if (!w.start(from, to[i], trim, r)) {
        rays[i] = Ray();
        continue;
      }
      // Rounding may carry a walk one voxel past its end, so that voxel must be in the block as
      // well; of all voxels between two, the one highest along every axis has the highest address.
      int beyond[3];
      for (int a = 0; a < 3; ++a) beyond[a] = floor_to_int(to[i][a] / r) + w.step[a];
      inside = contains(beyond[0], beyond[1], beyond[2]);
    }
    if (!inside) {
      rays[i] = cast(from, to[i], trim);
      continue;
    }
    const int l = used++;
    owner[l] = i;
    for (int a = 0; a < 3; ++a) {
      lanes.next[a][l] = w.next[a];
      lanes.delta[a][l] = w.delta[a];
      lanes.stride[a][l] = w.step[a] * stride[a];
    }
    lanes.address[l] = here;
    lanes.end[l] = w.end;
    lanes.active[l] = -1;
    if (used == kRays) flush();
  }
  flush();
}

}  // namespace prospect

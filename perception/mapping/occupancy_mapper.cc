// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/occupancy_mapper.h"

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/maps/column_levels.h"
#include "models/knobs.h"
#include "models/parameter_check.h"
#include "perception/mapping/block_table.h"
#include "perception/mapping/evidence_table.h"
#include "perception/mapping/floor_join.h"
#include "perception/mapping/map_evidence.h"

namespace prospect {
namespace {

constexpr int kKeyOrigin = 32768;  // OctoMap's key of address 0
constexpr int kMaxAddress = 32000;
constexpr int kBrick = 8;  // voxels along an edge of a brick: three levels of the octree
constexpr int kBrickVoxels = kBrick * kBrick * kBrick;
constexpr unsigned kBrickLevels = 3;
constexpr unsigned kTreeLevels = 16;
// Copies that snapshots take in turn: one for who plans, one for who checks, one to write.
constexpr int kMirrors = 3;

// Bits of a three-bit coordinate spread to every third place.
constexpr int kSpread[kBrick] = {0, 1, 8, 9, 64, 65, 72, 73};

// Order of voxels within a brick: that in which the octree numbers children (x lowest), level by
// level, so a brick's eighths are runs.
int morton(int x, int y, int z) { return kSpread[x] | (kSpread[y] << 1) | (kSpread[z] << 2); }

int compact(int m) { return (m & 1) | ((m >> 2) & 2) | ((m >> 4) & 4); }

std::uint64_t spread_wide(std::uint64_t v) {
  std::uint64_t m = 0;
  for (unsigned b = 0; b < kTreeLevels - kBrickLevels; ++b) m |= ((v >> b) & 1U) << (3 * b);
  return m;
}

// Of the points that hit a voxel, of the newest the more: heights over the voxel's bottom [m].
struct Heights {
  float count = 0.0F, mean = 0.0F, square = 0.0F;  // mean square about the mean

  void add(const Heights& more) {
    constexpr float kMost = 100.0F;  // of points before: our choice
    const float before = std::min(count, kMost), all = before + more.count;
    if (!(all > 0.0F)) return;
    const float share = more.count / all, off = more.mean - mean;
    mean += share * off;
    square += share * (more.square - square + (1.0F - share) * off * off);
    count = all;
  }
};

class LevelledOcTree : public octomap::OcTree, public ColumnLevels {
 public:
  explicit LevelledOcTree(double resolution) : octomap::OcTree(resolution) {}
};

struct Brick {
  float log_odds[kBrickVoxels] = {};
  std::uint64_t known[kBrick] = {};            // bit sets over the voxels
  std::uint64_t surface[kBrick] = {};          // has been occupied at some time
  std::uint64_t stale[kMirrors][kBrick] = {};  // the mirror does not show the newest value
  bool dirty[kMirrors] = {};                   // some bit of stale is set, and the mirror lists it
  int bx = 0, by = 0, bz = 0;                  // address / 8
  std::uint64_t order = 0;                     // Morton order of bricks
  std::uint32_t index = 0, column = 0;         // its own, and of its block of columns
  std::vector<Heights> heights;                // of what was met at z = 0 or above; empty: nothing
};

struct Columns {  // of an 8 x 8 square of ground cells: counts over layers, of the slice's
  std::uint16_t occupied[kBrick * kBrick] = {};
  std::uint16_t free[kBrick * kBrick] = {};
  std::uint16_t floor[kBrick * kBrick] = {};       // occupied, of the floor's layers
  std::uint16_t free_below[kBrick * kBrick] = {};  // free, of those below z = 0
  CellState sight[kBrick * kBrick] = {};           // of the voxel at the line of sight
  bool changed[kBrick * kBrick] = {};
  int bx = 0, by = 0;
  std::uint32_t index = 0;    // its own
  std::vector<Brick*> stack;  // from the lowest layer that is kept up; null: none there
};

// Address of the voxel that holds a coordinate; one on a face, to rounding, is above the face. Else
// the rays of one plane that lies on a face would be strewn over both layers.
int address_of(double x, double r) { return static_cast<int>(std::floor(x / r + 1e-9)); }

// Rays that are walked in turn, a voxel each. A step waits for the one before it; those of other
// rays fill the time. Marks are only ever set, so their order does not matter.
constexpr int kAbreast = 4;

// Where a ray runs in a voxel [m], at the place where it is nearest to the voxel's vertical axis,
// as seen from above: how far beside the axis, how far past the ray's end that is, and how far
// above the voxel's middle the ray is there.
struct Place {
  double beside = 0.0, past = 0.0, above = 0.0;
};

// A ray on its way from voxel to voxel.
struct Walk {
  double next[3];   // where it leaves v along each axis, of the ray
  double delta[3];  // how far apart such places are
  int v[3], last[3], step[3];
  std::ptrdiff_t stride[3];
  std::ptrdiff_t index = 0;  // of v's mark
  Place place, moves[3];     // in v, and what a step along each axis adds
  double spread = 0.0;       // [m] that it goes ahead while it rises or falls by one
  double up = 1.0;           // its sense upwards, 1 or -1
  int remaining = 0;         // steps
  bool include_end = false;  // the last voxel is passed, too

  void advance() {
    int axis = next[0] < next[1] ? 0 : 1;
    if (next[2] < next[axis]) axis = 2;
    v[axis] += step[axis];
    index += stride[axis];
    place.beside += moves[axis].beside;
    place.past += moves[axis].past;
    place.above += moves[axis].above;
    next[axis] =
        v[axis] == last[axis] ? std::numeric_limits<double>::infinity() : next[axis] + delta[axis];
  }
};

// What a scan says of a voxel: a byte of a sum of these.
constexpr std::uint8_t kPassed = 1, kEndedIn = 2, kGrazed = 4;
// ... and of one of the floor's: a ray went on through the floor's plane in it.
constexpr std::uint8_t kWentThrough = 8;

// Where a scan is marked.
struct Marking {
  double half;          // of a voxel [m]
  double core_squared;  // [m^2]
  double depth;         // into a layer [m] from which on a ray is inside
  int layer;            // that the rays come from
  std::uint8_t* marks;

  // 1 where the ray, as far as it is in the layer, passes the axis of the voxel that it is in.
  int passes_axis(const Walk& w) const {
    const Place& at = w.place;
    const double outside = (std::abs(at.above) - half) * w.spread;
    const double off = std::max(std::max(outside, at.past), 0.0);
    return at.beside * at.beside + off * off <= core_squared;
  }
  // Marks the voxel that the ray is in, by those of `what` that hold: as far as the ray is in the
  // layer, it passes the axis, inside the layer or grazing it. Without a branch: it cannot be
  // foreseen.
  void mark(const Walk& w, std::uint8_t what = kPassed | kGrazed) const {
    const Place& at = w.place;
    const int passes = passes_axis(w);
    const int inside = (w.v[2] == layer) | (half + at.above * w.up >= depth);
    const int mark = inside * kPassed + (1 - inside) * kGrazed;
    marks[w.index] |= static_cast<std::uint8_t>(-passes & mark & what);
  }
};

// True if nobody else holds the object, so that it may be written. The fence pairs with the release
// by which the last other holder let go of it.
template <typename T>
bool unshared(const std::shared_ptr<T>& p) {
  if (p.use_count() != 1) return false;
  std::atomic_thread_fence(std::memory_order_acquire);
  return true;
}

}  // namespace

DepthScan transform(const DepthScan& scan_B, const Pose& pose) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  DepthScan scan;
  scan.reach = scan_B.reach;
  scan.origin = R * scan_B.origin + pose.position;
  scan.hits.reserve(scan_B.hits.size());
  scan.misses.reserve(scan_B.misses.size());
  scan.passing.reserve(scan_B.passing.size());
  for (const auto& p : scan_B.hits) scan.hits.emplace_back(R * p + pose.position);
  for (const auto& p : scan_B.misses) scan.misses.emplace_back(R * p + pose.position);
  for (const auto& p : scan_B.passing) scan.passing.emplace_back(R * p + pose.position);
  return scan;
}

struct OccupancyMapper::Impl {
  struct GroundChange {
    Cell cell;
    CellState state = CellState::kUnknown;
    bool sight = false;
  };

  OccupancyMapperOptions options;
  float hit = 0.0F, miss = 0.0F, lowest = 0.0F, highest = 0.0F;  // log-odds
  float threshold = 0.0F;
  int k_low = 0, k_end = 0;  // layers kept
  SliceLayers slice;
  bool has_floor = true;  // its layers are kept

  std::vector<std::unique_ptr<Brick>> bricks;
  BlockTable<Columns> columns;
  std::vector<std::pair<std::uint32_t, int>> changed_cells;
  std::uint64_t surface = 0;
  MapEvidence* evidence = nullptr;  // what is entered is written down here
  EvidenceTable* table = nullptr;

  struct Mirror {
    std::shared_ptr<LevelledOcTree> octree;
    std::shared_ptr<VoxelGrid> voxels;
    std::vector<std::uint32_t> dirty;
  };
  Mirror mirror[kMirrors];
  int current = 0;

  struct GroundMirror {
    std::shared_ptr<GroundMap> map;       // null: not made
    std::vector<GroundChange> pending{};  // of the newest map, in order, and not yet of this one
  };
  GroundMirror ground[kMirrors];
  int ground_current = 0;  // the newest: nothing is pending

  // The scan at hand: one byte a voxel of a box around the origin, of kPassed and the others.
  std::vector<std::uint8_t> marks;
  int box[3] = {0, 0, 0};   // lowest address, a multiple of 8
  int size[3] = {0, 0, 0};  // multiples of 8
  Walk abreast[kAbreast];   // the first `walks` of them are to be marked yet
  int walks = 0;
  std::vector<Eigen::Vector3d> below_floor;  // ends of rays that went on through the floor's plane
  std::vector<Heights> met;                  // in the marked voxels; `square` is a sum of squares

  // Where the floor is not flat; null: it is taken for flat.
  std::unique_ptr<FloorJoin> floor;
  std::vector<Cell> low;                 // where what may be floor was met since it was looked for
  std::vector<Cell> levelled[kMirrors];  // columns that the mirror has at another level

  explicit Impl(const OccupancyMapperOptions& o);

  /// Of layers that are kept.
  Brick& brick(int bx, int by, int bz);
  bool is_kept(int k) const { return k >= k_low && k < k_end; }
  void set_value(Brick& b, int m, float value);
  /// Writes down that voxel m of a brick was told to have a value.
  void write_told(int bx, int by, int bz, int m, float value);
  void flush_ground();
  GroundMap& writable_ground();
  Walk begin_walk(const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool include_end) const;
  Marking marking_from(const Eigen::Vector3d& from) {
    const double half = 0.5 * options.resolution, core = options.core * options.resolution;
    // From a half on there is no graze.
    const double depth = core < half ? half - core : -std::numeric_limits<double>::infinity();
    return {half, core * core, depth, address_of(from.z(), options.resolution), marks.data()};
  }
  /// Marks the voxels that the segment clears as free, the one that holds `to` only if
  /// include_end: at once, or abreast with the next rays, which have the same origin.
  void mark_ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool include_end);
  void mark_abreast(const Eigen::Vector3d& from);
  /// Where the rays that end in `below_floor` went through the floor's layers.
  void mark_floor(const Eigen::Vector3d& from);
  bool is_floor(int k) const { return has_floor && k >= slice.floor.k_floor && k < 0; }
  /// Deeper than what the robot drives down.
  bool is_below_floor(double z) const { return has_floor && z < -options.slice.step; }
  int level(Cell c) const { return floor ? floor->level(c) : 0; }
  /// Of a block of columns; null: nothing is known there.
  const Brick* find_brick(const Columns* block, int k) const {
    return block != nullptr && is_kept(k)
               ? block->stack[static_cast<std::size_t>((k >> 3) - (k_low >> 3))]
               : nullptr;
  }
  bool is_occupied(const Brick& b, int m) const {
    return ((b.known[m >> 6] >> (m & 63)) & 1U) != 0 && b.log_odds[m] >= threshold;
  }
  /// Of the columns of a brick, whose first one is told.
  void levels_in(Cell first, int* up) const;
  const Columns* block_of(Cell c) const { return columns.find({c.i >> 3, c.j >> 3}); }
  /// Of the block of its column.
  CellState state_in(const Columns* block, int i, int j, int k) const;
  void note_heights(Brick& b, int m, int k, const Heights& more);
  void surfaces(Cell c, std::vector<FloorSurface>& found) const;
  bool is_foot(Cell c, int k, int above) const;
  void look_at_floor(std::vector<GroundChange>& changes);
  void note_change(Cell c, std::vector<GroundChange>& changes) const;
  void write_column(VoxelGrid& voxels, Cell c) const;
  void apply_marks();

  void sync();
  void replay(int which);
  void replay_octree(octomap::OcTree& tree, int which, const std::vector<std::uint32_t>& order);
  void replay_bricks(octomap::OcTree& tree, octomap::OcTreeNode* node, bool created, unsigned level,
                     const std::uint32_t* begin, const std::uint32_t* end, int which);
  void replay_voxels(octomap::OcTree& tree, octomap::OcTreeNode* node, bool created, unsigned level,
                     const Brick& b, int first, int which);
};

OccupancyMapper::Impl::Impl(const OccupancyMapperOptions& o) : options(o) {
  check_knobs("occupancy mapper", o);
  for (const std::string& misfit : {range_misfit(o), layers_misfit(o)}) {
    if (!misfit.empty()) throw std::invalid_argument("occupancy mapper: " + misfit);
  }
  slice = slice_layers(o.slice, o.resolution);
  hit = octomap::logodds(o.probability_hit);
  miss = octomap::logodds(o.probability_miss);
  lowest = octomap::logodds(o.probability_min);
  highest = octomap::logodds(o.probability_max);

  const GridFrame frame{o.resolution, 0, 0, 1, 1};
  mirror[0].voxels = std::make_shared<VoxelGrid>(frame, o.z_min, o.z_max);
  mirror[0].octree = std::make_shared<LevelledOcTree>(o.resolution);
  mirror[0].octree->setProbHit(o.probability_hit);
  mirror[0].octree->setProbMiss(o.probability_miss);
  mirror[0].octree->setClampingThresMin(o.probability_min);
  mirror[0].octree->setClampingThresMax(o.probability_max);
  mirror[0].octree->setOccupancyThres(0.5);
  threshold = mirror[0].octree->getOccupancyThresLog();
  ground[0].map = std::make_shared<GroundMap>(frame);
  k_low = mirror[0].voxels->k0();
  k_end = k_low + mirror[0].voxels->depth();
  has_floor = slice.floor.k_floor >= k_low;
  if (o.slopes && has_floor) {
    floor = std::make_unique<FloorJoin>(o.resolution, slice.floor.k_body, o.slice.step);
  }
}

Brick& OccupancyMapper::Impl::brick(int bx, int by, int bz) {
  Columns* block = columns.find({bx, by});
  if (block == nullptr) {
    block = &columns.add({bx, by});
    block->index = static_cast<std::uint32_t>(columns.size() - 1);
    block->bx = bx;
    block->by = by;
    block->stack.resize(static_cast<std::size_t>(((k_end - 1) >> 3) - (k_low >> 3) + 1));
  }
  Brick*& at = block->stack[static_cast<std::size_t>(bz - (k_low >> 3))];
  if (at == nullptr) {
    auto b = std::make_unique<Brick>();
    b->bx = bx;
    b->by = by;
    b->bz = bz;
    constexpr int kOrigin = kKeyOrigin / kBrick;
    b->order = spread_wide(static_cast<std::uint64_t>(bx + kOrigin)) |
               (spread_wide(static_cast<std::uint64_t>(by + kOrigin)) << 1) |
               (spread_wide(static_cast<std::uint64_t>(bz + kOrigin)) << 2);
    b->index = static_cast<std::uint32_t>(bricks.size());
    b->column = block->index;
    at = b.get();
    bricks.push_back(std::move(b));
  }
  return *at;
}

void OccupancyMapper::Impl::set_value(Brick& b, int m, float value) {
  const int word = m >> 6;
  const std::uint64_t bit = std::uint64_t{1} << (m & 63);
  const bool known = (b.known[word] & bit) != 0;
  float& current_value = b.log_odds[m];
  if (known && value == current_value) return;
  const bool was_occupied = known && current_value >= threshold;
  const bool was_free = known && !was_occupied;
  const bool occupied = value >= threshold;
  current_value = value;
  b.known[word] |= bit;
  for (int which = 0; which < kMirrors; ++which) {
    b.stale[which][word] |= bit;
    if (!b.dirty[which]) {
      b.dirty[which] = true;
      mirror[which].dirty.push_back(b.index);
    }
  }
  if (occupied && (b.surface[word] & bit) == 0) {
    b.surface[word] |= bit;
    ++surface;
  }
  if (occupied == was_occupied && known) return;
  const int k = b.bz * kBrick + compact(m >> 2);
  const bool in_slice = k >= slice.k_low && k <= slice.k_high;
  const bool is_support = k >= slice.floor.k_floor && k < slice.floor.k_body;
  const bool counts = in_slice || is_support || k == slice.k_sight;
  const int x = compact(m), y = compact(m >> 1);
  if (!counts && !(floor && floor->is_near({b.bx * kBrick + x, b.by * kBrick + y}))) return;
  Columns& c = columns[b.column];
  const int cell = x + kBrick * y;
  if (in_slice) {
    c.occupied[cell] = static_cast<std::uint16_t>(c.occupied[cell] + occupied - was_occupied);
    c.free[cell] = static_cast<std::uint16_t>(c.free[cell] + !occupied - was_free);
  }
  if (is_support) {
    c.floor[cell] = static_cast<std::uint16_t>(c.floor[cell] + occupied - was_occupied);
    if (k < 0) {
      c.free_below[cell] = static_cast<std::uint16_t>(c.free_below[cell] + !occupied - was_free);
    }
  }
  if (k == slice.k_sight) c.sight[cell] = occupied ? CellState::kOccupied : CellState::kFree;
  if (!c.changed[cell]) {
    c.changed[cell] = true;
    changed_cells.emplace_back(b.column, cell);
  }
}

void OccupancyMapper::Impl::write_told(int bx, int by, int bz, int m, float value) {
  if (evidence == nullptr) return;
  const int x = compact(m), y = compact(m >> 1), z = compact(m >> 2);
  evidence->brick({bx, by, bz}).states[static_cast<std::size_t>(MapEvidence::voxel(x, y, z))] =
      table->told(value);
  if (value < threshold) return;
  const Eigen::Vector3d at(kBrick * bx + x, kBrick * by + y, kBrick * bz + z);
  evidence->add_hit(at + Eigen::Vector3d::Constant(0.5), kBrick * bx + x, kBrick * by + y,
                    kBrick * bz + z);
}

void OccupancyMapper::Impl::levels_in(Cell first, int* up) const {
  static_assert(FloorJoin::kTile % kBrick == 0);
  if (floor) {
    floor->levels(first, kBrick, up);
  } else {
    std::fill_n(up, kBrick * kBrick, 0);
  }
}

CellState OccupancyMapper::Impl::state_in(const Columns* block, int i, int j, int k) const {
  const Brick* b = find_brick(block, k);
  const int m = morton(i & 7, j & 7, k & 7);
  if (b == nullptr || ((b->known[m >> 6] >> (m & 63)) & 1U) == 0) return CellState::kUnknown;
  return b->log_odds[m] >= threshold ? CellState::kOccupied : CellState::kFree;
}

void OccupancyMapper::Impl::note_heights(Brick& b, int m, int k, const Heights& more) {
  // What lies higher joins nothing.
  if (!floor || k < 0 || k * options.resolution > floor->highest() + FloorJoin::kBaseline) return;
  if (b.heights.empty()) b.heights.resize(kBrickVoxels);
  Heights& h = b.heights[static_cast<std::size_t>(m)];
  h.add(more);
  const double z = k * options.resolution + static_cast<double>(h.mean);
  if (k < slice.floor.k_body
          ? z + 1.5 * std::sqrt(static_cast<double>(h.square)) > options.slice.step
          : z <= floor->highest() + floor->most_rise()) {
    low.push_back({b.bx * kBrick + compact(m), b.by * kBrick + compact(m >> 1)});
  }
}

// What the floor of a column may be: what was met from the flat floor's layers on, with room for
// the body over it, and nothing unknown at its feet.
void OccupancyMapper::Impl::surfaces(Cell c, std::vector<FloorSurface>& found) const {
  const double r = options.resolution;
  const int room = slice.k_high - (slice.floor.k_body - 1);
  const int highest = static_cast<int>((floor->highest() + floor->most_rise()) / r) + 1;
  int k = std::min(k_end - 1, highest + room);
  int occupied_above = k_end + room;  // the lowest
  CellState above = CellState::kUnknown;
  const Columns* block = block_of(c);
  const Brick* b = find_brick(block, k);
  for (; k >= slice.floor.k_floor; --k) {
    if ((k & 7) == 7) b = find_brick(block, k);
    const int m = morton(c.i & 7, c.j & 7, k & 7);
    const bool known = b != nullptr && ((b->known[m >> 6] >> (m & 63)) & 1U) != 0;
    const CellState here = !known                        ? CellState::kUnknown
                           : b->log_odds[m] >= threshold ? CellState::kOccupied
                                                         : CellState::kFree;
    if (here == CellState::kOccupied) {
      const bool stands = above == CellState::kFree && occupied_above > k + room && k <= highest;
      const Heights* h = b->heights.empty() ? nullptr : &b->heights[static_cast<std::size_t>(m)];
      if (stands && k < 0) {
        found.push_back({k, 0.0, true, false});
      } else if (stands && h != nullptr && h->count > 0.0F) {
        // Faces are met all over the height of a voxel, floors at theirs.
        constexpr double kFace = 0.15;  // [voxels]: our choice
        constexpr float kLeast = 5.0F;  // points: our choice
        const double mean = k * r + static_cast<double>(h->mean);
        const double sigma = std::sqrt(static_cast<double>(h->square));
        const bool is_low = k < slice.floor.k_body && mean + 1.5 * sigma > options.slice.step;
        const bool is_sure = h->count >= kLeast;
        found.push_back({k, mean, is_sure && sigma <= kFace * r && !(is_low && is_foot(c, k, 2)),
                         is_sure && is_low && !is_foot(c, k, 1)});
      }
      occupied_above = k;
    }
    above = here;
  }
}

// Whether something stands beside, `above` layers higher or more, whose foot is low, too; or, of
// the next layer, may stand there.
bool OccupancyMapper::Impl::is_foot(Cell c, int k, int above) const {
  for (int j = c.j - 1; j <= c.j + 1; ++j) {
    for (int i = c.i - 1; i <= c.i + 1; ++i) {
      const Columns* block = block_of({i, j});
      if (above == 1 && state_in(block, i, j, k + 1) != CellState::kFree) return true;
      for (int up = k + above; up <= slice.k_high + 1; ++up) {
        if (state_in(block, i, j, up) == CellState::kOccupied) return true;
      }
    }
  }
  return false;
}

// Notes what a column is over a floor that is raised or closed there.
void OccupancyMapper::Impl::note_change(Cell c, std::vector<GroundChange>& changes) const {
  const Columns* block = block_of(c);
  const int up = level(c);
  int occupied = 0, free = 0, support = 0, free_below = 0;
  for (int k = std::min(slice.k_low, slice.floor.k_floor);
       k <= std::max(slice.k_high, slice.floor.k_body - 1); ++k) {
    const CellState s = state_in(block, c.i, c.j, k + up);
    const bool in_slice = k >= slice.k_low && k <= slice.k_high;
    const bool is_support = k >= slice.floor.k_floor && k < slice.floor.k_body;
    occupied += in_slice && s == CellState::kOccupied;
    free += in_slice && s == CellState::kFree;
    support += is_support && s == CellState::kOccupied;
    free_below += is_support && k < 0 && s == CellState::kFree;
  }
  const FloorState under = floor_state(support, free_below, -slice.floor.k_floor);
  const CellState now =
      floor->closed(c) ? CellState::kOccupied : project_column(occupied, free, under);
  const bool sight =
      see_through(now, slice.k_sight ? state_in(block, c.i, c.j, *slice.k_sight + up) : now);
  const GroundMap& known = *ground[ground_current].map;
  if (known.state(c) != now || known.see_through(c) != sight) changes.push_back({c, now, sight});
}

void OccupancyMapper::Impl::look_at_floor(std::vector<GroundChange>& changes) {
  if (!floor->is_flat()) {
    for (const auto& [block, cell] : changed_cells) {
      const Columns& b = columns[block];
      const Cell c{b.bx * kBrick + cell % kBrick, b.by * kBrick + cell / kBrick};
      if (floor->is_near(c)) low.push_back(c);
    }
  }
  if (low.empty()) return;
  std::sort(low.begin(), low.end(), scan_less);
  low.erase(std::unique(low.begin(), low.end()), low.end());
  floor->look(low, [this](Cell c, std::vector<FloorSurface>& found) { surfaces(c, found); });
  low.clear();
  for (const Cell c : floor->changed()) {
    for (std::vector<Cell>& list : levelled) list.push_back(c);
    note_change(c, changes);
  }
}

void OccupancyMapper::Impl::write_column(VoxelGrid& voxels, Cell c) const {
  const Columns* block = block_of(c);
  const int up = level(c);
  for (int k = k_low; k < k_end; ++k) {
    const CellState s = k + up < k_end ? state_in(block, c.i, c.j, k + up) : CellState::kUnknown;
    voxels.set(c.i, c.j, k, s);
  }
}

void OccupancyMapper::Impl::flush_ground() {
  std::vector<GroundChange> changes;
  if (floor) look_at_floor(changes);
  const GroundMap& now = *ground[ground_current].map;
  for (const auto& [block, cell] : changed_cells) {
    Columns& c = columns[block];
    c.changed[cell] = false;
    const Cell address{c.bx * kBrick + cell % kBrick, c.by * kBrick + cell / kBrick};
    const FloorState under = floor_state(c.floor[cell], c.free_below[cell], -slice.floor.k_floor);
    const CellState state = project_column(c.occupied[cell], c.free[cell], under);
    const bool sight = see_through(state, slice.k_sight ? c.sight[cell] : state);
    if (floor && (floor->level(address) != 0 || floor->closed(address))) {
      note_change(address, changes);
      continue;
    }
    if (now.state(address) == state && now.see_through(address) == sight) continue;
    changes.push_back({address, state, sight});
  }
  changed_cells.clear();
  if (changes.empty()) return;
  GroundMap& next = writable_ground();
  for (const GroundChange& c : changes) next.set(c.cell, c.state, c.sight);
  for (int which = 0; which < kMirrors; ++which) {
    GroundMirror& other = ground[which];
    if (which == ground_current || !other.map) continue;
    other.pending.insert(other.pending.end(), changes.begin(), changes.end());
    if (other.pending.size() > static_cast<std::size_t>(next.frame().size())) {
      other = {};  // a copy costs less
    }
  }
}

// The newest ground map, in an object that no snapshot holds. The same changes in the same order
// give the same map to the bit, its revisions included.
GroundMap& OccupancyMapper::Impl::writable_ground() {
  if (!unshared(ground[ground_current].map)) {
    int next = -1, unmade = -1;
    for (int which = 0; which < kMirrors; ++which) {
      const GroundMirror& m = ground[which];
      if (!m.map) unmade = which;
      if (which == ground_current || !m.map || !unshared(m.map)) continue;
      if (next < 0 || m.pending.size() < ground[next].pending.size()) next = which;
    }
    if (next >= 0) {
      for (const GroundChange& c : ground[next].pending) {
        ground[next].map->set(c.cell, c.state, c.sight);
      }
    } else {
      next = unmade >= 0 ? unmade : (ground_current + 1) % kMirrors;
      ground[next].map = std::make_shared<GroundMap>(*ground[ground_current].map);
    }
    ground[next].pending.clear();
    ground_current = next;
  }
  return *ground[ground_current].map;
}

Walk OccupancyMapper::Impl::begin_walk(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       bool include_end) const {
  const double r = options.resolution;
  const std::ptrdiff_t strides[3] = {static_cast<std::ptrdiff_t>(size[1]) * size[2], size[2], 1};
  Walk w;
  w.include_end = include_end;
  for (int a = 0; a < 3; ++a) {
    w.v[a] = address_of(from[a], r);
    w.last[a] = address_of(to[a], r);
    const double d = to[a] - from[a];
    w.step[a] = w.last[a] > w.v[a] ? 1 : -1;
    w.stride[a] = w.step[a] * strides[a];
    w.remaining += std::abs(w.last[a] - w.v[a]);
    if (w.last[a] == w.v[a]) {
      w.next[a] = w.delta[a] = std::numeric_limits<double>::infinity();
    } else {
      w.next[a] = ((w.v[a] + (w.step[a] > 0 ? 1 : 0)) * r - from[a]) / d;
      w.delta[a] = r / std::abs(d);
    }
    w.index += (w.v[a] - box[a]) * strides[a];
  }
  const Eigen::Vector3d ray = to - from;
  constexpr double kSteep = 1e6;  // what stands for a vertical ray
  const double length = ray.head<2>().norm();
  const Eigen::Vector2d ahead =
      length > 0.0 ? Eigen::Vector2d(ray.head<2>() / length) : Eigen::Vector2d::UnitX();
  const double slope = std::clamp(ray.z() / std::max(length, 1e-300), -kSteep, kSteep);
  w.spread = 1.0 / std::max(std::abs(slope), 1.0 / kSteep);
  w.up = w.step[2];
  const auto place = [&](double x, double y, double z) {
    const double along = x * ahead.x() + y * ahead.y();
    return Place{x * ahead.y() - y * ahead.x(), along, along * slope - z};
  };
  const auto middle = [&](int a) { return r * (w.v[a] + 0.5) - from[a]; };
  w.place = place(middle(0), middle(1), middle(2));
  w.place.past -= length;
  w.moves[0] = place(r * w.step[0], 0.0, 0.0);
  w.moves[1] = place(0.0, r * w.step[1], 0.0);
  w.moves[2] = place(0.0, 0.0, r * w.step[2]);
  return w;
}

void OccupancyMapper::Impl::mark_ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     bool include_end) {
  const Walk walk = begin_walk(from, to, include_end);
  const auto inside = [&](int k) { return k >= box[2] && k < box[2] + size[2]; };
  // All x and y of the segment lie inside the box; heights may leave it.
  if (inside(walk.v[2]) && inside(walk.last[2])) {
    abreast[walks++] = walk;
    if (walks == kAbreast) mark_abreast(from);
    return;
  }
  const Marking marking = marking_from(from);
  for (Walk w = walk;; --w.remaining) {
    if (w.remaining == 0) {
      if (include_end && inside(w.v[2])) marking.mark(w, kPassed);
      break;
    }
    if (inside(w.v[2])) marking.mark(w);
    w.advance();
  }
}

void OccupancyMapper::Impl::mark_abreast(const Eigen::Vector3d& from) {
  const Marking marking = marking_from(from);
  // Copies: a byte that is written could be one of a member.
  Walk ray[kAbreast];
  const int count = std::exchange(walks, 0);
  std::copy(abreast, abreast + count, ray);
  if (count == kAbreast) {
    int together = ray[0].remaining;
    for (const Walk& w : ray) together = std::min(together, w.remaining);
    for (int i = 0; i < together; ++i) {
      for (Walk& w : ray) {
        marking.mark(w);
        w.advance();
      }
    }
    for (Walk& w : ray) w.remaining -= together;
  }
  for (int k = 0; k < count; ++k) {
    Walk w = ray[k];
    for (; w.remaining > 0; --w.remaining) {
      marking.mark(w);
      w.advance();
    }
    if (w.include_end) marking.mark(w, kPassed);
  }
}

void OccupancyMapper::Impl::mark_floor(const Eigen::Vector3d& from) {
  const Marking marking = marking_from(from);
  const auto mark = [&](const Walk& w) {
    if (!is_floor(w.v[2]) || w.v[2] < box[2] || w.v[2] >= box[2] + size[2]) return;
    if (marking.passes_axis(w) != 0) marks[static_cast<std::size_t>(w.index)] |= kWentThrough;
  };
  const double bottom = slice.floor.k_floor * options.resolution;
  for (const Eigen::Vector3d& end : below_floor) {
    const Eigen::Vector3d ray = end - from;
    const double last = std::min(1.0, (bottom - from.z()) / ray.z());
    if (!(ray.z() < 0.0) || !(last > 0.0)) continue;
    Walk w = begin_walk(from, from + last * ray, false);
    for (; w.remaining > 0; --w.remaining) {
      mark(w);
      w.advance();
    }
    mark(w);
  }
  below_floor.clear();
}

void OccupancyMapper::Impl::apply_marks() {
  int up[kBrick * kBrick] = {};        // levels of the columns
  bool through[kBrick * kBrick] = {};  // went a ray on through the layers of the floor?
  for (int x = 0; x < size[0]; x += kBrick) {
    for (int y = 0; y < size[1]; y += kBrick) {
      levels_in({box[0] + x, box[1] + y}, up);
      std::fill(std::begin(through), std::end(through), false);
      for (int z = 0; z < size[2]; z += kBrick) {
        Brick* b = nullptr;
        MapEvidence::Brick* written = nullptr;
        for (int dx = 0; dx < kBrick; ++dx) {
          for (int dy = 0; dy < kBrick; ++dy) {
            const std::size_t first =
                (static_cast<std::size_t>(x + dx) * static_cast<std::size_t>(size[1]) +
                 static_cast<std::size_t>(y + dy)) *
                    static_cast<std::size_t>(size[2]) +
                static_cast<std::size_t>(z);
            std::uint8_t* run = &marks[first];
            std::uint64_t any = 0;
            std::memcpy(&any, run, sizeof any);
            if (any == 0) continue;
            if (b == nullptr) {
              const int bx = (box[0] + x) / kBrick, by = (box[1] + y) / kBrick,
                        bz = (box[2] + z) / kBrick;  // exact: multiples of eight
              b = &brick(bx, by, bz);
              written = evidence != nullptr ? &evidence->brick({bx, by, bz}) : nullptr;
            }
            for (int dz = 0; dz < kBrick; ++dz) {
              if (run[dz] == 0) continue;
              const int k = box[2] + z + dz;
              if (k < k_low || k >= k_end) continue;
              // A ray that ends on the floor, or in its noise, says nothing of what is below it.
              if (is_floor(k)) {
                run[dz] = (run[dz] & kEndedIn) != 0       ? kEndedIn
                          : (run[dz] & kWentThrough) != 0 ? kPassed
                                                          : std::uint8_t{0};
                if (run[dz] == 0) continue;
              }
              const int m = morton(dx, dy, dz);
              if (floor && (run[dz] & kEndedIn) != 0) {
                Heights here = std::exchange(met[first + static_cast<std::size_t>(dz)], {});
                if (here.count > 0.0F) {
                  here.mean /= here.count;
                  here.square = std::max(0.0F, here.square / here.count - here.mean * here.mean);
                  note_heights(*b, m, k, here);
                }
              }
              const int cell = dx + kBrick * dy;
              if (up[cell] > 0) {
                // Over a raised floor, too, a ray says something of the floor only if it ends in
                // its layers, or goes on through them.
                const int flat = k - up[cell];
                if (flat == slice.floor.k_floor - 1) through[cell] = (run[dz] & kPassed) != 0;
                if (flat >= slice.floor.k_floor && flat < slice.floor.k_body && !through[cell] &&
                    (run[dz] & kEndedIn) == 0 && is_occupied(*b, m)) {
                  continue;
                }
              }
              if (written != nullptr) {
                EvidenceTable::State& s =
                    written->states[static_cast<std::size_t>(MapEvidence::voxel(dx, dy, dz))];
                s = (run[dz] & kEndedIn) != 0  ? table->after_hit(s)
                    : (run[dz] & kPassed) != 0 ? table->after_miss(s)
                                               : table->after_graze(s);
              }
              const bool known = ((b->known[m >> 6] >> (m & 63)) & 1U) != 0;
              if (known && run[dz] == kGrazed) continue;
              const float before = known ? b->log_odds[m] : 0.0F;
              const float after = before + ((run[dz] & kEndedIn) != 0 ? hit : miss);
              set_value(*b, m, std::min(std::max(after, lowest), highest));
            }
            std::memset(run, 0, kBrick);
          }
        }
      }
    }
  }
}

// --- mirrors -------------------------------------------------------------------------------------

void OccupancyMapper::Impl::sync() {
  if (mirror[current].dirty.empty() && levelled[current].empty()) return;
  const auto writable = [](const Mirror& m) {
    return m.octree && unshared(m.octree) && unshared(m.voxels);
  };
  if (!writable(mirror[current])) {
    int next = -1, unmade = -1;
    for (int which = 0; which < kMirrors; ++which) {
      const Mirror& m = mirror[which];
      if (!m.octree) unmade = which;
      if (which == current || !writable(m)) continue;
      if (next < 0 || m.dirty.size() < mirror[next].dirty.size()) next = which;
    }
    if (next < 0) {
      next = unmade >= 0 ? unmade : (current + 1) % kMirrors;
      Mirror& to = mirror[next];
      const Mirror& from = mirror[current];
      to.octree = std::make_shared<LevelledOcTree>(*from.octree);
      to.voxels = std::make_shared<VoxelGrid>(*from.voxels);
      for (const std::uint32_t index : to.dirty) {
        Brick& b = *bricks[index];
        b.dirty[next] = false;
        std::fill(std::begin(b.stale[next]), std::end(b.stale[next]), 0);
      }
      to.dirty = from.dirty;
      levelled[next] = levelled[current];
      for (const std::uint32_t index : to.dirty) {
        Brick& b = *bricks[index];
        b.dirty[next] = true;
        std::copy(std::begin(b.stale[current]), std::end(b.stale[current]),
                  std::begin(b.stale[next]));
      }
    }
    current = next;
  }
  replay(current);
}

void OccupancyMapper::Impl::replay(int which) {
  Mirror& m = mirror[which];
  std::sort(m.dirty.begin(), m.dirty.end(), [this](std::uint32_t a, std::uint32_t b) {
    return bricks[a]->order < bricks[b]->order;
  });
  VoxelGrid& voxels = *m.voxels;
  int up[kBrick * kBrick];
  for (const std::uint32_t index : m.dirty) {
    const Brick& b = *bricks[index];
    levels_in({b.bx * kBrick, b.by * kBrick}, up);
    for (int word = 0; word < kBrick; ++word) {
      for (std::uint64_t bits = b.stale[which][word]; bits != 0; bits &= bits - 1) {
        const int v = word * 64 + std::countr_zero(bits);
        const int x = compact(v), y = compact(v >> 1);
        voxels.set(b.bx * kBrick + x, b.by * kBrick + y,
                   b.bz * kBrick + compact(v >> 2) - up[x + kBrick * y],
                   b.log_odds[v] >= threshold ? CellState::kOccupied : CellState::kFree);
      }
    }
  }
  for (const Cell c : levelled[which]) {
    write_column(voxels, c);
    m.octree->set_level(c, level(c));
  }
  levelled[which].clear();
  replay_octree(*m.octree, which, m.dirty);
  for (const std::uint32_t index : m.dirty) {
    Brick& b = *bricks[index];
    b.dirty[which] = false;
    std::fill(std::begin(b.stale[which]), std::end(b.stale[which]), 0);
  }
  m.dirty.clear();
}

void OccupancyMapper::Impl::replay_octree(octomap::OcTree& tree, int which,
                                          const std::vector<std::uint32_t>& order) {
  if (order.empty()) return;
  if (tree.getRoot() == nullptr) {
    // The library makes a root only through a first value; the replay below sets it again.
    const Brick& b = *bricks[order.front()];
    int word = 0;
    while (b.stale[which][word] == 0) ++word;
    const int v = word * 64 + std::countr_zero(b.stale[which][word]);
    const auto key = [](int address) {
      return static_cast<octomap::key_type>(address + kKeyOrigin);
    };
    tree.setNodeValue(
        octomap::OcTreeKey(key(b.bx * kBrick + compact(v)), key(b.by * kBrick + compact(v >> 1)),
                           key(b.bz * kBrick + compact(v >> 2))),
        b.log_odds[v], true);
  }
  replay_bricks(tree, tree.getRoot(), false, kTreeLevels - kBrickLevels, order.data(),
                order.data() + order.size(), which);
}

// Goes down the tree once for all changed bricks, in Morton order, and repairs each inner node on
// the way back: the cost is that of the changes, not of the tree.
void OccupancyMapper::Impl::replay_bricks(octomap::OcTree& tree, octomap::OcTreeNode* node,
                                          bool created, unsigned level, const std::uint32_t* begin,
                                          const std::uint32_t* end, int which) {
  if (level == 0) {
    assert(end - begin == 1);
    replay_voxels(tree, node, created, kBrickLevels, *bricks[*begin], 0, which);
    return;
  }
  if (!created && !tree.nodeHasChildren(node)) tree.expandNode(node);
  const unsigned shift = 3 * (level - 1);
  while (begin != end) {
    const unsigned child = static_cast<unsigned>((bricks[*begin]->order >> shift) & 7U);
    const std::uint32_t* run = begin + 1;
    while (run != end && ((bricks[*run]->order >> shift) & 7U) == child) ++run;
    const bool fresh = !tree.nodeChildExists(node, child);
    octomap::OcTreeNode* below =
        fresh ? tree.createNodeChild(node, child) : tree.getNodeChild(node, child);
    replay_bricks(tree, below, fresh, level - 1, begin, run, which);
    begin = run;
  }
  if (!tree.pruneNode(node)) node->updateOccupancyChildren();
}

void OccupancyMapper::Impl::replay_voxels(octomap::OcTree& tree, octomap::OcTreeNode* node,
                                          bool created, unsigned level, const Brick& b, int first,
                                          int which) {
  if (!created && !tree.nodeHasChildren(node)) tree.expandNode(node);
  const int run = 1 << (3 * (level - 1));  // voxels of a child: 64, 8 or 1
  for (unsigned child = 0; child < 8; ++child) {
    const int at = first + static_cast<int>(child) * run;
    const std::uint64_t mask = (run == 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << run) - 1))
                               << (at & 63);
    if ((b.stale[which][at >> 6] & mask) == 0) continue;
    const bool fresh = !tree.nodeChildExists(node, child);
    octomap::OcTreeNode* below =
        fresh ? tree.createNodeChild(node, child) : tree.getNodeChild(node, child);
    if (level == 1) {
      below->setLogOdds(b.log_odds[at]);
    } else {
      replay_voxels(tree, below, fresh, level - 1, b, at, which);
    }
  }
  if (!tree.pruneNode(node)) node->updateOccupancyChildren();
}

// --- interface -----------------------------------------------------------------------------------

OccupancyMapper::OccupancyMapper(const OccupancyMapperOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
OccupancyMapper::~OccupancyMapper() = default;
OccupancyMapper::OccupancyMapper(OccupancyMapper&&) noexcept = default;
OccupancyMapper& OccupancyMapper::operator=(OccupancyMapper&&) noexcept = default;

const OccupancyMapperOptions& OccupancyMapper::options() const { return impl_->options; }
std::uint64_t OccupancyMapper::surface_voxels() const { return impl_->surface; }

void OccupancyMapper::record(MapEvidence* evidence, EvidenceTable* table) {
  impl_->evidence = table != nullptr ? evidence : nullptr;
  impl_->table = table;
}

void OccupancyMapper::enter(const MapEvidence& evidence, const EvidenceTable& table) {
  Impl& m = *impl_;
  constexpr int kMost = kMaxAddress / kBrick;
  for (const auto& [at, said] : evidence.bricks()) {
    if (std::abs(at[0]) > kMost || std::abs(at[1]) > kMost) continue;
    const int k = at[2] * kBrick;
    if (k + kBrick <= m.k_low || k >= m.k_end) continue;
    Brick& b = m.brick(at[0], at[1], at[2]);
    for (int n = 0; n < kBrickVoxels; ++n) {
      const EvidenceTable::State s = said.states[static_cast<std::size_t>(n)];
      const int z = n % kBrick;
      if (s == EvidenceTable::kNothing || k + z < m.k_low || k + z >= m.k_end) continue;
      const int v = morton(n / (kBrick * kBrick), n / kBrick % kBrick, z);
      const bool known = ((b.known[v >> 6] >> (v & 63)) & 1U) != 0;
      m.set_value(b, v, known ? table.of_known(s, b.log_odds[v]) : table.of_unknown(s));
    }
    for (const MapEvidence::Hit& hit : said.hits) {
      const int z = hit.voxel % kBrick;
      if (k + z < m.k_low || k + z >= m.k_end) continue;
      const auto r = static_cast<float>(m.options.resolution);
      m.note_heights(b, morton(hit.voxel / (kBrick * kBrick), hit.voxel / kBrick % kBrick, z),
                     k + z,
                     {static_cast<float>(hit.count), r * (hit.mean.z() - static_cast<float>(z)),
                      r * r * hit.spread});
    }
  }
  m.flush_ground();
}

void OccupancyMapper::insert(const DepthScan& scan) {
  Impl& m = *impl_;
  const double r = m.options.resolution;
  const double limit = (kMaxAddress - 512) * r;
  if (!scan.origin.allFinite() || scan.origin.cwiseAbs().maxCoeff() > limit) return;

  if (!(scan.reach > 0.0)) return;
  const double max_range = std::min(m.options.max_range, scan.reach);
  const int reach = static_cast<int>(std::ceil(max_range / r)) + 2;
  for (int a = 0; a < 3; ++a) {
    const int center = address_of(scan.origin[a], r);
    int low = center - reach;
    int high = center + reach;
    if (a == 2) {
      low = std::max(low, m.k_low);
      high = std::min(high, m.k_end - 1);
      if (low > high) return;
    }
    m.box[a] = low & ~(kBrick - 1);
    m.size[a] = ((high - m.box[a]) / kBrick + 1) * kBrick;
  }
  // All zero between scans: apply_marks() clears what it reads.
  const std::size_t volume = static_cast<std::size_t>(m.size[0]) *
                             static_cast<std::size_t>(m.size[1]) *
                             static_cast<std::size_t>(m.size[2]);
  if (m.marks.size() < volume) {
    m.marks.resize(volume, 0);
    if (m.floor) m.met.resize(volume);
  }

  const auto walk_miss = [&](const Eigen::Vector3d& direction) {
    const Eigen::Vector3d end = scan.origin + direction * max_range;
    m.mark_ray(scan.origin, end, false);
    if (m.is_below_floor(end.z())) m.below_floor.push_back(end);
  };
  for (const Eigen::Vector3d& point : scan.hits) {
    const Eigen::Vector3d ray = point - scan.origin;
    const double range = ray.norm();
    if (!std::isfinite(range) || range < 1e-9) continue;
    const Eigen::Vector3d direction = ray / range;
    if (range > max_range) {
      walk_miss(direction);
      continue;
    }
    const double offset =
        std::min(0.5 * r, m.options.offset_constant + m.options.offset_quadratic * range * range);
    const Eigen::Vector3d end = point + direction * offset;
    Eigen::Vector3d surface = end / r;
    int voxel[3];
    int measured[3];
    for (int a = 0; a < 3; ++a) {
      voxel[a] = address_of(end[a], r);
      measured[a] = address_of(point[a], r);
    }
    // What is deeper than the robot's step is none of the floor's layers.
    if (m.is_below_floor(point.z())) {
      m.below_floor.push_back(point);
      voxel[2] = std::min(voxel[2], m.slice.floor.k_floor - 1);
      surface.z() = std::min(surface.z(), m.slice.floor.k_floor - 0.5);
    }
    const bool same = voxel[0] == measured[0] && voxel[1] == measured[1] && voxel[2] == measured[2];
    // The measured point may lie in a voxel before the one entered as hit: that one was passed.
    m.mark_ray(scan.origin, point, !same);
    if (voxel[2] >= m.k_low && voxel[2] < m.k_end) {
      const std::size_t at =
          (static_cast<std::size_t>(voxel[0] - m.box[0]) * static_cast<std::size_t>(m.size[1]) +
           static_cast<std::size_t>(voxel[1] - m.box[1])) *
              static_cast<std::size_t>(m.size[2]) +
          static_cast<std::size_t>(voxel[2] - m.box[2]);
      m.marks[at] |= kEndedIn;
      if (m.floor && voxel[2] >= 0) {
        const auto z = static_cast<float>(point.z() - voxel[2] * r);
        Heights& here = m.met[at];
        here.count += 1.0F;
        here.mean += z;
        here.square += z * z;
      }
      if (m.evidence != nullptr) m.evidence->add_hit(surface, voxel[0], voxel[1], voxel[2]);
    }
  }
  for (const Eigen::Vector3d& point : scan.misses) {
    const Eigen::Vector3d ray = point - scan.origin;
    const double range = ray.norm();
    if (!std::isfinite(range) || range < 1e-9) continue;
    walk_miss(ray / range);
  }
  for (const Eigen::Vector3d& point : scan.passing) {
    const Eigen::Vector3d ray = point - scan.origin;
    const double range = ray.norm();
    if (!std::isfinite(range) || range < 1e-9) continue;
    m.mark_ray(scan.origin, scan.origin + std::min(1.0, max_range / range) * ray, false);
  }
  m.mark_abreast(scan.origin);
  m.mark_floor(scan.origin);
  m.apply_marks();
  m.flush_ground();
}

void OccupancyMapper::clear_cylinder(const Eigen::Vector3d& base, double radius, double height) {
  Impl& m = *impl_;
  const double r = m.options.resolution;
  if (!base.allFinite() || !std::isfinite(radius) || !std::isfinite(height) ||
      radius > 1000.0 * r || base.cwiseAbs().maxCoeff() > (kMaxAddress - 2048) * r) {
    return;
  }
  const auto address = [r](double x) { return static_cast<int>(std::floor(x / r)); };
  const int k_from = std::max(address(base.z()), m.k_low);
  const int k_to = std::min(address(base.z() + std::min(height, 2000.0)), m.k_end - 1);
  for (int j = address(base.y() - radius); j <= address(base.y() + radius); ++j) {
    for (int i = address(base.x() - radius); i <= address(base.x() + radius); ++i) {
      const double dx = (i + 0.5) * r - base.x(), dy = (j + 0.5) * r - base.y();
      if (dx * dx + dy * dy > radius * radius) continue;
      for (int k = k_from; k <= k_to; ++k) {
        const double z = (k + 0.5) * r - base.z();
        if (z < 0.0 || z > height) continue;
        const int bx = i >> 3, by = j >> 3, bz = k >> 3;
        Brick& b = m.brick(bx, by, bz);
        const int v = morton(i & 7, j & 7, k & 7);
        const bool known = ((b.known[v >> 6] >> (v & 63)) & 1U) != 0;
        if (known && b.log_odds[v] >= m.threshold) continue;
        m.set_value(b, v, m.lowest);
        m.write_told(bx, by, bz, v, m.lowest);
      }
    }
  }
  m.flush_ground();
}

void OccupancyMapper::assume_floor(const Eigen::Vector2d& at, double radius) {
  Impl& m = *impl_;
  const double r = m.options.resolution;
  if (!m.has_floor || !m.is_kept(-1) || !at.allFinite() || !(radius > 0.0 && radius < 1000.0 * r) ||
      at.cwiseAbs().maxCoeff() > (kMaxAddress - 2048) * r) {
    return;
  }
  const std::uint64_t surface = m.surface;
  const auto address = [r](double x) { return static_cast<int>(std::floor(x / r)); };
  for (int j = address(at.y() - radius); j <= address(at.y() + radius); ++j) {
    for (int i = address(at.x() - radius); i <= address(at.x() + radius); ++i) {
      if (std::hypot((i + 0.5) * r - at.x(), (j + 0.5) * r - at.y()) > radius) continue;
      const int bx = i >> 3, by = j >> 3, bz = -1, v = morton(i & 7, j & 7, kBrick - 1);
      Brick& b = m.brick(bx, by, bz);
      const std::uint64_t bit = std::uint64_t{1} << (v & 63);
      if ((b.known[v >> 6] & bit) != 0) continue;
      m.set_value(b, v, m.hit);
      m.write_told(bx, by, bz, v, m.hit);
      b.surface[v >> 6] &= ~bit;
    }
  }
  m.surface = surface;
  m.flush_ground();
}

void OccupancyMapper::load(const octomap::OcTree& map) {
  Impl& m = *impl_;
  check_parameter(map.getResolution() == m.options.resolution, "occupancy mapper",
                  "resolution of the map to load", map.getResolution(),
                  std::to_string(m.options.resolution) + " m, that of the map to be built");
  constexpr int kMost = kMaxAddress - 2000;
  const std::uint64_t surface = m.surface;
  for (auto leaf = map.begin_leafs(), end = map.end_leafs(); leaf != end; ++leaf) {
    // A pruned leaf stands for 2^n voxels along each axis.
    const int size = 1 << (kTreeLevels - leaf.getDepth());
    const octomap::OcTreeKey first = leaf.getIndexKey();
    const int low[3] = {first[0] - kKeyOrigin, first[1] - kKeyOrigin, first[2] - kKeyOrigin};
    for (const int address : low) {
      check_parameter(std::abs(address) <= kMost && std::abs(address + size) <= kMost,
                      "occupancy mapper", "address in the map to load", address,
                      "within " + std::to_string(kMost) + " voxels of the origin");
    }
    const float value = map.isNodeOccupied(*leaf) ? m.hit : m.miss;
    for (int i = low[0]; i < low[0] + size; ++i) {
      for (int j = low[1]; j < low[1] + size; ++j) {
        for (int k = std::max(low[2], m.k_low); k < std::min(low[2] + size, m.k_end); ++k) {
          const int bx = i >> 3, by = j >> 3, bz = k >> 3;
          Brick& b = m.brick(bx, by, bz);
          const int v = morton(i & 7, j & 7, k & 7);
          const std::uint64_t bit = std::uint64_t{1} << (v & 63);
          const bool seen = (b.surface[v >> 6] & bit) != 0;
          m.set_value(b, v, value);
          m.write_told(bx, by, bz, v, value);
          if (!seen) b.surface[v >> 6] &= ~bit;
        }
      }
    }
  }
  m.surface = surface;
  m.flush_ground();
}

std::shared_ptr<const octomap::OcTree> OccupancyMapper::octree() {
  impl_->sync();
  return impl_->mirror[impl_->current].octree;
}
std::shared_ptr<const VoxelGrid> OccupancyMapper::voxels() {
  impl_->sync();
  return impl_->mirror[impl_->current].voxels;
}
double OccupancyMapper::floor_level(const Eigen::Vector2d& at) const {
  const double r = impl_->options.resolution;
  const GridFrame frame{r, 0, 0, 1, 1};
  return r * impl_->level(frame.cell(at.x(), at.y()));
}
std::shared_ptr<const GroundMap> OccupancyMapper::ground() {
  return impl_->ground[impl_->ground_current].map;
}

}  // namespace prospect

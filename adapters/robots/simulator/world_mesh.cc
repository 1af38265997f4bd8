// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/world_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/robots/simulator/hashed_draws.h"
#include "models/mixed_bits.h"

namespace prospect {
namespace {

constexpr double kOverlap = 2e-5;       // [m] that rectangles reach beyond their faces
constexpr double kSmallestMark = 0.03;  // [m]
constexpr double kLargestMark = 0.08;
constexpr double kPlainTexel = 0.05;  // [m] of rectangles without marks
constexpr double kLattice = 0.1;      // [m] between which the grey below the marks is interpolated
constexpr int kGutter = 2;  // texels of the surroundings about a texture, which would else repeat

/// Value noise in [-1, 1]: random numbers at the points of a lattice, smoothly interpolated.
double value_noise(const Eigen::Vector3d& p, double size, std::uint64_t seed) {
  const Eigen::Vector3d q = p / size;
  const Eigen::Vector3d whole = q.array().floor();
  Eigen::Vector3d w = q - whole;
  for (double& x : w) x = x * x * (3.0 - 2.0 * x);
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    std::uint64_t h = mixed_bits(seed);
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) {
      const int bit = corner >> a & 1;
      weight *= bit != 0 ? w[a] : 1.0 - w[a];
      const auto x = static_cast<std::int64_t>(whole[a]) + bit;
      h = mixed_bits(h ^ static_cast<std::uint64_t>(x));
    }
    sum += weight * (2.0 * unit_interval(h) - 1.0);
  }
  return sum;
}

/// The side of a plane of voxel faces: normal `sign` along `axis`, at `axis` = plane r.
struct FaceSide {
  int axis;
  int sign;
  int plane;
  auto key() const { return std::tuple(axis, sign, plane); }
  bool operator<(const FaceSide& other) const { return key() < other.key(); }
  int across() const { return (axis + 1) % 3; }
  int along() const { return (axis + 2) % 3; }
};

/// Of a plane's faces, in voxels: [i, i + width) across and [j, j + height) along.
struct FaceRectangle {
  int i, j, width, height;
};

/// A convex polygon: the points p with normals[n] . p <= distances[n].
struct Polygon {
  int sides = 0;
  std::array<Eigen::Vector2f, 6> normals;
  std::array<float, 6> distances{};

  Polygon(HashedDraws& draws, double size) {
    sides = 3 + static_cast<int>(draws.uniform() * 4.0);
    const double turn = draws.uniform(0.0, 2.0 * std::numbers::pi);
    // So that no corner is farther from the middle than `size`.
    const double jitter = sides == 3 ? 0.1 : 0.15;
    for (int n = 0; n < sides; ++n) {
      const double angle =
          turn + 2.0 * std::numbers::pi * (n + draws.uniform(-jitter, jitter)) / sides;
      normals[static_cast<std::size_t>(n)] =
          Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>();
      distances[static_cast<std::size_t>(n)] =
          static_cast<float>(size * draws.uniform(sides == 3 ? 0.2 : 0.3, sides == 3 ? 0.3 : 0.45));
    }
  }
  /// How much of the texel about p it covers, by the distance of p to its edges.
  float cover(const Eigen::Vector2f& p, float texel) const {
    float inside = 1e9f;
    for (int n = 0; n < sides; ++n) {
      const auto k = static_cast<std::size_t>(n);
      inside = std::min(inside, distances[k] - normals[k].dot(p));
    }
    return std::clamp(0.5f + inside / texel, 0.0f, 1.0f);
  }
};

struct Mark {
  Eigen::Vector2d centre;  ///< across, along [m]
  double size;             ///< [m]
  Polygon outer, inner;
  float outer_contrast, inner_contrast;  ///< [grey levels]; an inner one of 0 is not there

  Mark(const Eigen::Vector2d& at, std::uint64_t hash) : Mark(at, HashedDraws(hash)) {}

 private:
  Mark(const Eigen::Vector2d& at, HashedDraws draws)
      : centre(at),
        size(draws.uniform(kSmallestMark, kLargestMark)),
        outer(draws, size),
        inner(draws, 0.45 * size) {
    const double sign = draws.uniform() < 0.5 ? -1.0 : 1.0;
    outer_contrast = static_cast<float>(sign * draws.uniform(60.0, 100.0));
    inner_contrast =
        draws.uniform() < 0.6 ? static_cast<float>(-sign * draws.uniform(60.0, 130.0)) : 0.0f;
  }
};

class Painter {
 public:
  Painter(const World& world, const FeatureField& features, const WorldMeshOptions& options)
      : voxels_(world.voxels), r_(world.voxels.resolution()), options_(options) {
    for (std::uint32_t n = 0; n < features.features().size(); ++n) {
      const Feature& feature = features.features()[n];
      int axis = 0;
      feature.normal.cwiseAbs().maxCoeff(&axis);
      const FaceSide side{axis, feature.normal[axis] > 0.0 ? 1 : -1,
                          static_cast<int>(std::lround(feature.position[axis] / r_))};
      marks_[side].emplace_back(
          Eigen::Vector2d(feature.position[side.across()], feature.position[side.along()]),
          mixed_bits(mixed_bits(options.seed) ^ n));
    }
  }

  TexturedMesh mesh() {
    const GridFrame& f = voxels_.frame();
    const std::array<int, 3> low = {f.i0, f.j0, voxels_.k0()};
    const std::array<int, 3> size = {f.width, f.height, voxels_.depth()};
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {1, -1}) {
        for (int n = 0; n < size[static_cast<std::size_t>(axis)]; ++n) {
          cover(axis, sign, low[static_cast<std::size_t>(axis)] + n, low, size);
        }
      }
    }
    return std::move(mesh_);
  }

 private:
  /// The faces of the free voxels of one layer whose surface looks along `sign`.
  void cover(int axis, int sign, int layer, const std::array<int, 3>& low,
             const std::array<int, 3>& size) {
    const FaceSide side{axis, sign, sign > 0 ? layer : layer + 1};
    const auto b = static_cast<std::size_t>(side.across());
    const auto c = static_cast<std::size_t>(side.along());
    const int width = size[b], height = size[c];
    exposed_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    const auto at = [&](int i, int j) -> std::uint8_t& {
      return exposed_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(i)];
    };
    bool any = false;
    for (int j = 0; j < height; ++j) {
      for (int i = 0; i < width; ++i) {
        std::array<int, 3> v;
        v[static_cast<std::size_t>(axis)] = layer;
        v[b] = low[b] + i;
        v[c] = low[c] + j;
        if (voxels_.state(v[0], v[1], v[2]) != CellState::kFree) continue;
        v[static_cast<std::size_t>(axis)] -= sign;
        if (voxels_.state(v[0], v[1], v[2]) == CellState::kFree) continue;
        at(i, j) = 1;
        any = true;
      }
    }
    if (!any) return;
    for (int j = 0; j < height; ++j) {
      for (int i = 0; i < width; ++i) {
        if (at(i, j) == 0) continue;
        FaceRectangle rectangle{i, j, 1, 1};
        while (i + rectangle.width < width && at(i + rectangle.width, j) != 0) ++rectangle.width;
        const auto row_is_exposed = [&](int row) {
          for (int k = i; k < i + rectangle.width; ++k) {
            if (at(k, row) == 0) return false;
          }
          return true;
        };
        while (j + rectangle.height < height && row_is_exposed(j + rectangle.height)) {
          ++rectangle.height;
        }
        for (int n = j; n < j + rectangle.height; ++n) {
          for (int k = i; k < i + rectangle.width; ++k) at(k, n) = 0;
        }
        add(side, {low[b] + i, low[c] + j, rectangle.width, rectangle.height});
      }
    }
  }

  void add(const FaceSide& side, const FaceRectangle& rectangle) {
    const Eigen::Vector2d corner = r_ * Eigen::Vector2d(rectangle.i, rectangle.j);
    const Eigen::Vector2d extent = r_ * Eigen::Vector2d(rectangle.width, rectangle.height);
    const std::vector<const Mark*> marks = marks_near(side, corner, extent);
    const double texel = marks.empty() ? kPlainTexel : options_.texel;
    const Eigen::Vector2i texels =
        (extent / texel).array().round().max(1.0).cast<int>() + 2 * kGutter;
    const Eigen::Vector2d step = extent.array() / (texels.array() - 2 * kGutter).cast<double>();
    mesh_.textures.push_back(paint(side, corner, step, texels, marks));

    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int n = 0; n < 4; ++n) {
      const Eigen::Vector2d end(n & 1 ? 1.0 : 0.0, n & 2 ? 1.0 : 0.0);
      const Eigen::Vector2d within =
          end.cwiseProduct(extent).array() + (2.0 * end.array() - 1.0) * kOverlap;
      Eigen::Vector3d p;
      p[side.axis] = side.plane * r_;
      p[side.across()] = corner.x() + within.x();
      p[side.along()] = corner.y() + within.y();
      mesh_.vertices.emplace_back(p.cast<float>());
      mesh_.uv.emplace_back(
          ((within.array() / step.array() + kGutter) / texels.array().cast<double>())
              .cast<float>());
    }
    const auto texture = static_cast<std::uint32_t>(mesh_.textures.size() - 1);
    mesh_.triangles.push_back({first, first + 1, first + 3});
    mesh_.triangles.push_back({first, first + 3, first + 2});
    mesh_.material.insert(mesh_.material.end(), 2, texture);
  }

  std::vector<const Mark*> marks_near(const FaceSide& side, const Eigen::Vector2d& corner,
                                      const Eigen::Vector2d& extent) const {
    std::vector<const Mark*> near;
    const auto found = marks_.find(side);
    if (options_.texture_quality == 0.0 || found == marks_.end()) return near;
    for (const Mark& mark : found->second) {
      const Eigen::Array2d outside =
          (corner - mark.centre).array().max((mark.centre - corner - extent).array());
      if (outside.maxCoeff() < mark.size) near.push_back(&mark);
    }
    return near;
  }

  /// The grey below the marks.
  double ground(const FaceSide& side, const Eigen::Vector3d& p) const {
    constexpr double kFloor = 0.05;  // [m] up to where a surface that looks up is the floor
    const double plain = side.axis != 2   ? 175.0
                         : side.sign < 0  ? 190.0
                         : p.z() > kFloor ? 180.0
                                          : 140.0;
    return plain + 5.0 * value_noise(p, 1.1, options_.seed) +
           3.0 * value_noise(p, 0.53, options_.seed + 1);
  }

  Image paint(const FaceSide& side, const Eigen::Vector2d& corner, const Eigen::Vector2d& step,
              const Eigen::Vector2i& texels, const std::vector<const Mark*>& marks) const {
    const int width = texels.x(), height = texels.y();
    const auto centre = [&](int axis, int n) {
      return corner[axis] + (n - kGutter + 0.5) * step[axis];
    };
    // The ground, at the points of a lattice that all rectangles of the plane share.
    const auto cell = [&](int axis, int n) {
      return static_cast<int>(std::floor(centre(axis, n) / kLattice));
    };
    const int i0 = cell(0, 0), j0 = cell(1, 0);
    const int columns = cell(0, width - 1) - i0 + 2, rows = cell(1, height - 1) - j0 + 2;
    std::vector<float> lattice;
    lattice.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        Eigen::Vector3d p;
        p[side.axis] = side.plane * r_;
        p[side.across()] = (i0 + i) * kLattice;
        p[side.along()] = (j0 + j) * kLattice;
        lattice.push_back(static_cast<float>(ground(side, p)));
      }
    }
    std::vector<float> grey(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<int> left(static_cast<std::size_t>(width));
    std::vector<float> share(static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x) {
      const auto k = static_cast<std::size_t>(x);
      left[k] = cell(0, x) - i0;
      share[k] = static_cast<float>(centre(0, x) / kLattice - cell(0, x));
    }
    for (int y = 0; y < height; ++y) {
      const int j = cell(1, y);
      const auto b = static_cast<float>(centre(1, y) / kLattice - j);
      const float* upper = lattice.data() + static_cast<std::ptrdiff_t>(j - j0) * columns;
      const float* lower = upper + columns;
      float* row = grey.data() + static_cast<std::ptrdiff_t>(y) * width;
      for (int x = 0; x < width; ++x) {
        const int i = left[static_cast<std::size_t>(x)];
        const float a = share[static_cast<std::size_t>(x)];
        const float above = upper[i] + a * (upper[i + 1] - upper[i]);
        const float below = lower[i] + a * (lower[i + 1] - lower[i]);
        row[x] = above + b * (below - above);
      }
    }
    const auto quality = static_cast<float>(options_.texture_quality);
    const auto texel = static_cast<float>(step.maxCoeff());
    for (const Mark* mark : marks) {
      const auto range = [&](int axis, int size) {
        const double middle = (mark->centre[axis] - corner[axis]) / step[axis] + kGutter;
        const double reach = mark->size / step[axis];
        return std::pair(std::max(0, static_cast<int>(middle - reach)),
                         std::min(size, static_cast<int>(middle + reach) + 1));
      };
      const auto [x0, x1] = range(0, width);
      const auto [y0, y1] = range(1, height);
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const Eigen::Vector2f p =
              (Eigen::Vector2d(centre(0, x), centre(1, y)) - mark->centre).cast<float>();
          const float cover = mark->outer.cover(p, texel);
          if (cover == 0.0f) continue;
          const float inner = mark->inner_contrast == 0.0f ? 0.0f : mark->inner.cover(p, texel);
          const float contrast = mark->outer_contrast + inner * mark->inner_contrast;
          float& g = grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x)];
          g += cover * quality * contrast;
        }
      }
    }
    Image image(width, height);
    std::transform(grey.begin(), grey.end(), image.pixels.begin(), [](float g) {
      // NOLINTNEXTLINE(bugprone-incorrect-roundings): it is not negative
      return static_cast<std::uint8_t>(std::clamp(g, 10.0f, 245.0f) + 0.5f);
    });
    return image;
  }

  const VoxelGrid& voxels_;
  double r_;
  WorldMeshOptions options_;
  std::map<FaceSide, std::vector<Mark>> marks_;
  std::vector<std::uint8_t> exposed_;
  TexturedMesh mesh_;
};

}  // namespace

TexturedMesh world_mesh(const World& world, const FeatureField& features,
                        const WorldMeshOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("world mesh: " + what);
  };
  if (!(options.texture_quality >= 0.0 && options.texture_quality <= 1.0)) {
    refuse("texture_quality is " + std::to_string(options.texture_quality) + ", expected 0..1");
  }
  if (!(options.texel >= 0.001 && options.texel <= 0.1)) {
    refuse("texel is " + std::to_string(options.texel) + ", expected 0.001..0.1 m");
  }
  TexturedMesh mesh = Painter(world, features, options).mesh();
  if (mesh.triangles.empty()) refuse("the world has no free voxels");
  return mesh;
}

}  // namespace prospect

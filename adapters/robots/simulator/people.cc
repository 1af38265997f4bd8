// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/people.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "adapters/robots/simulator/hashed_draws.h"

namespace prospect {
namespace {

constexpr double kFarthestPerson = 15.0;  // [m]

/// A box [low, high] with the cloth over each of its sides, a repeat every 0.4 m.
void add_box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint32_t cloth,
             TexturedMesh& mesh) {
  for (int axis = 0; axis < 3; ++axis) {
    const int across = (axis + 1) % 3, along = (axis + 2) % 3;
    for (const float side : {low[axis], high[axis]}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int n = 0; n < 4; ++n) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[across] = (n & 1) != 0 ? high[across] : low[across];
        p[along] = (n & 2) != 0 ? high[along] : low[along];
        mesh.vertices.push_back(p);
        mesh.uv.emplace_back(Eigen::Vector2f(p[across], p[along]) / 0.4f);
      }
      mesh.triangles.push_back({first, first + 1, first + 3});
      mesh.triangles.push_back({first, first + 3, first + 2});
      mesh.material.insert(mesh.material.end(), 2, cloth);
    }
  }
}

/// Squares of 5 cm, each of a grey about one of its own.
Image checked_cloth(HashedDraws& draws) {
  constexpr int kSquares = 8, kTexels = 8;
  const double middle = draws.uniform(50.0, 190.0);
  Image image(kSquares * kTexels, kSquares * kTexels);
  for (int j = 0; j < kSquares; ++j) {
    for (int i = 0; i < kSquares; ++i) {
      const auto grey = static_cast<std::uint8_t>(middle + draws.uniform(-45.0, 45.0));
      for (int n = 0; n < kTexels * kTexels; ++n) {
        image.at(i * kTexels + n % kTexels, j * kTexels + n / kTexels) = grey;
      }
    }
  }
  return image;
}

/// Where a body lies in an image: empty, if nowhere.
PixelWindow window_of(const PinholeCamera& camera, const Eigen::Isometry3d& T_CP) {
  constexpr double kNearest = 0.1;  // [m] of depth
  double left = camera.width, right = 0.0, top = camera.height, bottom = 0.0;
  int behind = 0;
  for (int n = 0; n < 8; ++n) {
    const Eigen::Vector3d corner((n & 1) != 0 ? kWalkerWidest : -kWalkerWidest,
                                 (n & 2) != 0 ? kWalkerWidest : -kWalkerWidest,
                                 (n & 4) != 0 ? kWalkerTallest : 0.0);
    const Eigen::Vector3d p = T_CP * corner;
    if (p.z() < kNearest) {
      ++behind;
      continue;
    }
    const Eigen::Vector2d at = camera.project(p);
    left = std::min(left, at.x());
    right = std::max(right, at.x());
    top = std::min(top, at.y());
    bottom = std::max(bottom, at.y());
  }
  if (behind == 8) return {};
  // So near that a part lies behind: anywhere.
  if (behind > 0) left = top = 0.0, right = camera.width, bottom = camera.height;
  PixelWindow window;
  window.u = static_cast<int>(std::clamp(std::floor(left), 0.0, camera.width));
  window.v = static_cast<int>(std::clamp(std::floor(top), 0.0, camera.height));
  window.width = static_cast<int>(std::clamp(std::ceil(right) + 1.0, 0.0, camera.width)) - window.u;
  window.height =
      static_cast<int>(std::clamp(std::ceil(bottom) + 1.0, 0.0, camera.height)) - window.v;
  return window;
}

struct BodyPicture {
  PixelWindow window;
  PixelLayer layer;
};

/// None: nothing of a person lies in the image, whatever hides it.
std::optional<BodyPicture> picture_of(const Person& person, const PinholeCamera& camera,
                                      const Eigen::Isometry3d& T_WC, int threads) {
  const Eigen::Isometry3d T_PC = person.T_WP.inverse() * T_WC;
  if (!(T_PC.translation().norm() < kFarthestPerson)) return std::nullopt;
  const PixelWindow window = window_of(camera, T_PC.inverse());
  if (window.width <= 0 || window.height <= 0) return std::nullopt;
  PixelLayer layer = person.body->look(camera, T_PC, window, threads);
  if (std::all_of(layer.depth.begin(), layer.depth.end(), [](float z) { return std::isnan(z); })) {
    return std::nullopt;
  }
  return BodyPicture{window, std::move(layer)};
}

/// The part of its window that shows the body.
PixelWindow shown(const BodyPicture& body) {
  int left = body.window.width, right = -1, top = body.window.height, bottom = -1;
  std::size_t at = 0;
  for (int v = 0; v < body.window.height; ++v) {
    for (int u = 0; u < body.window.width; ++u, ++at) {
      if (std::isnan(body.layer.depth[at])) continue;
      left = std::min(left, u);
      right = std::max(right, u);
      top = std::min(top, v);
      bottom = std::max(bottom, v);
    }
  }
  return {body.window.u + left, body.window.v + top, right - left + 1, bottom - top + 1};
}

template <typename Change>
void each_pixel_within(const PixelWindow& window, const PinholeCamera& camera,
                       const Change& change) {
  for (int n = 0; n < window.width * window.height; ++n) {
    const int u = window.u + n % window.width, v = window.v + n / window.width;
    change(static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width) +
               static_cast<std::size_t>(u),
           static_cast<std::size_t>(n));
  }
}

}  // namespace

TexturedMesh person_mesh(std::uint64_t seed) {
  TexturedMesh mesh;
  HashedDraws draws(seed);
  for (int n = 0; n < 3; ++n) mesh.textures.push_back(checked_cloth(draws));
  constexpr std::uint32_t kCloths[] = {0, 0, 1, 1, 1, 2};  // of each box
  std::size_t part = 0;
  for (const Eigen::AlignedBox3f& box : person_boxes()) {
    add_box(box.min(), box.max(), kCloths[part++], mesh);
  }
  return mesh;
}

std::span<const Person> People::of(std::span<const Walker> walkers) {
  constexpr std::size_t kBodies = 3;
  while (bodies_.size() < std::min(kBodies, walkers.size())) {
    bodies_.push_back(
        std::make_shared<const SceneRenderer>(person_mesh(mixed_bits(seed_ + bodies_.size()))));
  }
  people_.clear();
  for (std::size_t n = 0; n < walkers.size(); ++n) {
    const Walker& walker = walkers[n];
    people_.push_back({Eigen::Translation3d(walker.at.x(), walker.at.y(), 0.0) *
                           Eigen::AngleAxisd(walker.heading, Eigen::Vector3d::UnitZ()),
                       bodies_[n % kBodies]});
  }
  return people_;
}

void draw_people(std::span<const Person> people, const SceneRenderer& scene,
                 const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, int threads,
                 std::vector<float>& grey) {
  std::vector<Person> far_first(people.begin(), people.end());
  std::stable_sort(far_first.begin(), far_first.end(), [&](const Person& a, const Person& b) {
    return (a.T_WP.translation() - T_WC.translation()).norm() >
           (b.T_WP.translation() - T_WC.translation()).norm();
  });
  for (const Person& person : far_first) {
    const auto body = picture_of(person, camera, T_WC, threads);
    if (!body) continue;
    const PixelWindow part = shown(*body);
    const std::vector<float> behind = scene.depth(camera, T_WC, part, threads);
    each_pixel_within(part, camera, [&](std::size_t at, std::size_t n) {
      const int u = part.u - body->window.u + static_cast<int>(n) % part.width;
      const int v = part.v - body->window.v + static_cast<int>(n) / part.width;
      const auto there = static_cast<std::size_t>(v * body->window.width + u);
      // Comparisons with NaN are false.
      const float z = body->layer.depth[there];
      if (!std::isnan(z) && !(behind[n] < z)) grey[at] = body->layer.grey[there];
    });
  }
}

void draw_people(std::span<const Person> people, const PinholeCamera& camera,
                 const Eigen::Isometry3d& T_WC, int threads, DepthImage& depth,
                 std::vector<float>& incidence) {
  for (const Person& person : people) {
    const auto body = picture_of(person, camera, T_WC, threads);
    if (!body) continue;
    each_pixel_within(body->window, camera, [&](std::size_t at, std::size_t n) {
      const float z = body->layer.depth[n];
      if (std::isnan(z) || depth.depth[at] < z) return;
      depth.depth[at] = z;
      incidence[at] = body->layer.cosine[n];
    });
  }
}

}  // namespace prospect

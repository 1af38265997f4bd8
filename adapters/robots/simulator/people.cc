// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/people.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/robots/simulator/hashed_draws.h"

namespace prospect {
namespace {

constexpr double kWalkingSpeed = 1.2;              // [m/s]
constexpr double kTallest = 1.85, kWidest = 0.35;  // [m] of a body, from its middle
constexpr double kFarthestPerson = 15.0;           // [m]

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
    const Eigen::Vector3d corner((n & 1) != 0 ? kWidest : -kWidest,
                                 (n & 2) != 0 ? kWidest : -kWidest, (n & 4) != 0 ? kTallest : 0.0);
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
  const auto pair = [&](float x, float inside, float outside, float low, float high,
                        std::uint32_t cloth) {
    add_box({-x, inside, low}, {x, outside, high}, cloth, mesh);
    add_box({-x, -outside, low}, {x, -inside, high}, cloth, mesh);
  };
  pair(0.09f, 0.02f, 0.18f, 0.0f, 0.85f, 0);                      // legs
  add_box({-0.12f, -0.2f, 0.85f}, {0.12f, 0.2f, 1.5f}, 1, mesh);  // trunk
  pair(0.05f, 0.21f, 0.3f, 0.8f, 1.45f, 1);                       // arms
  add_box({-0.1f, -0.08f, 1.55f}, {0.1f, 0.08f, 1.8f}, 2, mesh);  // head
  return mesh;
}

Walkers::Walkers(const World& world, double density, const Pose& start, std::uint64_t seed)
    : random_(seed) {
  BodySlice body;
  body.z_min = 0.05;
  body.z_max = kTallest;
  body.standing_clearance = 0.3;
  // Where the ceiling is low, what reaches the robot's height has to do.
  const double top = (world.voxels.k0() + world.voxels.depth()) * world.voxels.resolution();
  body.z_max = std::min(body.z_max, 0.8 * top);
  floor_ = standing_columns(world.voxels, body);
  for (int n = 0; n < floor_.frame.size(); ++n) {
    if (floor_.data[static_cast<std::size_t>(n)] != 0) places_.push_back(floor_.frame.at(n));
  }
  const double r = floor_.frame.resolution;
  const auto count =
      static_cast<int>(std::lround(density * static_cast<double>(places_.size()) * r * r / 100.0));
  constexpr int kBodies = 3;
  std::vector<std::shared_ptr<const SceneRenderer>> bodies;
  for (int n = 0; n < count; ++n) {
    if (n < kBodies) {
      bodies.push_back(std::make_shared<const SceneRenderer>(
          person_mesh(mixed_bits(seed + static_cast<std::uint64_t>(n)))));
    }
    Way way;
    for (int tries = 0; tries < 100; ++tries) {
      way.at = any_place();
      if ((way.at - start.position.head<2>()).norm() >= 2.0) break;
    }
    choose(way);
    ways_.push_back(way);
    people_.push_back(
        {Eigen::Isometry3d::Identity(), bodies[static_cast<std::size_t>(n % kBodies)]});
  }
  advance(0.0, start);
}

bool Walkers::walkable(const Eigen::Vector2d& place) const {
  return floor_.get(floor_.frame.cell(place.x(), place.y()), 0) != 0;
}

Eigen::Vector2d Walkers::any_place() {
  return floor_.frame.center(places_[static_cast<std::size_t>(random_() % places_.size())]);
}

bool Walkers::straight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const double step = 0.25 * floor_.frame.resolution;
  const int count = static_cast<int>(std::ceil((to - from).norm() / step));
  for (int n = 1; n <= count; ++n) {
    if (!walkable(from + (to - from) * n / count)) return false;
  }
  return true;
}

void Walkers::choose(Way& way) {
  way.target = way.at;
  way.waited = 0.0;
  way.rest = 0.5 + 2.5 * unit_interval(random_());
  for (int tries = 0; tries < 100; ++tries) {
    const Eigen::Vector2d place = any_place();
    const double length = (place - way.at).norm();
    if (length < 1.0 || length > 8.0 || !straight(way.at, place)) continue;
    way.target = place;
    break;
  }
}

void Walkers::step(Way& way, double dt, const Eigen::Vector2d& robot) {
  constexpr double kKept = 1.0;      // [m] from the robot
  constexpr double kPatience = 2.0;  // [s]
  if (way.rest > 0.0) {
    way.rest -= dt;
    return;
  }
  const Eigen::Vector2d ahead = way.target - way.at;
  const double left = ahead.norm();
  if (left < 1e-9) return choose(way);
  const Eigen::Vector2d next = way.at + ahead / left * std::min(left, kWalkingSpeed * dt);
  const double distance = (next - robot).norm();
  if (distance < kKept && distance < (way.at - robot).norm()) {
    way.waited += dt;
    if (way.waited > kPatience) choose(way);
    return;
  }
  way.heading = std::atan2(ahead.y(), ahead.x());
  way.at = next;
}

void Walkers::advance(double stamp, const Pose& robot) {
  constexpr double kStep = 0.05;  // [s]
  while (stamp_ < stamp) {
    const double dt = std::min(kStep, stamp - stamp_);
    for (Way& way : ways_) step(way, dt, robot.position.head<2>());
    stamp_ = stamp - stamp_ > kStep ? stamp_ + kStep : stamp;
  }
  for (std::size_t n = 0; n < ways_.size(); ++n) {
    people_[n].T_WP = Eigen::Translation3d(ways_[n].at.x(), ways_[n].at.y(), 0.0) *
                      Eigen::AngleAxisd(ways_[n].heading, Eigen::Vector3d::UnitZ());
  }
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
    const PixelLayer behind = scene.look(camera, T_WC, body->window, threads);
    each_pixel_within(body->window, camera, [&](std::size_t at, std::size_t n) {
      // Comparisons with NaN are false.
      const float z = body->layer.depth[n];
      if (!std::isnan(z) && !(behind.depth[n] < z)) grey[at] = body->layer.grey[n];
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

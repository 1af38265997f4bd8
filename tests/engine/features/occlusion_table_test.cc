// SPDX-License-Identifier: Apache-2.0
#include "engine/features/occlusion_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "tests/engine/view_worlds.h"

namespace prospect::occlusion_table_test {
namespace {

using test::uniform;

/// Points on occupied voxels that a free voxel touches, as landmarks are.
std::vector<Eigen::Vector3d> surface_points(const VoxelGrid& grid, int count,
                                            std::mt19937_64& random) {
  std::vector<Eigen::Vector3d> points;
  while (static_cast<int>(points.size()) < count) {
    const Eigen::Vector3d p(uniform(random, -6, 6), uniform(random, -6, 6), uniform(random, 0, 2));
    const Eigen::Vector3i v = grid.voxel(p);
    if (grid.state(v.x(), v.y(), v.z()) != CellState::kOccupied) continue;
    const bool exposed = grid.state(v.x() + 1, v.y(), v.z()) == CellState::kFree ||
                         grid.state(v.x() - 1, v.y(), v.z()) == CellState::kFree ||
                         grid.state(v.x(), v.y() + 1, v.z()) == CellState::kFree ||
                         grid.state(v.x(), v.y() - 1, v.z()) == CellState::kFree;
    if (exposed) points.push_back(p);
  }
  return points;
}

bool clear_of_walls(const VoxelGrid& grid, const Eigen::Vector3d& p, double radius) {
  const Eigen::Vector3i lo = grid.voxel(p.array() - radius), hi = grid.voxel(p.array() + radius);
  for (int i = lo.x(); i <= hi.x(); ++i) {
    for (int j = lo.y(); j <= hi.y(); ++j) {
      if (grid.state(i, j, grid.voxel(p).z()) == CellState::kOccupied) return false;
    }
  }
  return true;
}

/// P(score of a visible one > score of a hidden one), ties half: by ranks.
double area_under_curve(std::vector<std::pair<double, bool>> scored) {
  std::sort(scored.begin(), scored.end());
  double rank_sum = 0.0, positives = 0.0;
  for (std::size_t i = 0; i < scored.size();) {
    std::size_t j = i;
    while (j < scored.size() && scored[j].first == scored[i].first) ++j;
    const double rank = 0.5 * static_cast<double>(i + 1 + j);
    for (std::size_t m = i; m < j; ++m) {
      if (scored[m].second) rank_sum += rank, positives += 1.0;
    }
    i = j;
  }
  const double negatives = static_cast<double>(scored.size()) - positives;
  return (rank_sum - positives * (positives + 1.0) / 2.0) / (positives * negatives);
}

TEST(OcclusionTable, PredictsHardRayCasts) {
  std::vector<std::pair<double, bool>> scored;
  double brier = 0.0;
  for (int world = 0; world < 4; ++world) {
    std::mt19937_64 random(static_cast<std::uint64_t>(10 + world));
    const VoxelGrid grid = test::hall(random, false);
    const OcclusionTable::Options options;
    const OcclusionTable table(SensorLattice::around({0, 0, 0.45}, 2.5, 0.2),
                               surface_points(grid, 200, random), grid, options);
    std::vector<double> p(200);
    for (int n = 0; n < 60;) {
      const Eigen::Vector3d sensor(uniform(random, -2.5, 2.5), uniform(random, -2.5, 2.5), 0.45);
      if (!clear_of_walls(grid, sensor, 0.2)) continue;
      ++n;
      table.evaluate(sensor, p.data());
      for (std::size_t i = 0; i < p.size(); ++i) {
        if ((table.points()[i] - sensor).norm() > options.max_range) continue;
        const bool visible = !grid.cast(sensor, table.points()[i], options.trim).blocked;
        scored.emplace_back(p[i], visible);
        brier += (p[i] - visible) * (p[i] - visible);
      }
    }
  }
  brier /= static_cast<double>(scored.size());
  const double auc = area_under_curve(scored);
  const auto visible =
      std::count_if(scored.begin(), scored.end(), [](const auto& s) { return s.second; });
  std::printf("occlusion table: %zu pairs, %.0f %% visible, AUC %.4f, Brier %.4f\n", scored.size(),
              100.0 * static_cast<double>(visible) / static_cast<double>(scored.size()), auc,
              brier);
  RecordProperty("auc", std::to_string(auc));
  RecordProperty("brier", std::to_string(brier));
  EXPECT_GE(auc, 0.97);
  EXPECT_LE(brier, 0.06);
}

TEST(OcclusionTable, EqualsTheSplineOfHardCasts) {
  std::mt19937_64 random(5);
  const VoxelGrid grid = test::hall(random, true, 0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 50; ++i) {
    points.emplace_back(uniform(random, -7, 7), uniform(random, -7, 7), uniform(random, 0, 2.4));
  }
  OcclusionTable::Options options;
  options.max_range = 6.0;
  for (const bool vertical : {false, true}) {
    const SensorLattice lattice = SensorLattice::around({3.3, 0.1, 0.8}, 0.5, 0.2, vertical);
    const OcclusionTable table(lattice, points, grid, options);
    std::vector<double> p(points.size());
    for (int n = 0; n < 20; ++n) {
      const Eigen::Vector3d sensor(uniform(random, 2.8, 3.8), uniform(random, -0.4, 0.6),
                                   vertical ? uniform(random, 0.4, 1.2) : 0.8);
      table.evaluate(sensor, p.data());
      // The quadratic B-spline by its definition, at every node.
      const auto basis = [](double d) {
        d = std::abs(d);
        return d <= 0.5 ? 0.75 - d * d : d < 1.5 ? 0.5 * (1.5 - d) * (1.5 - d) : 0.0;
      };
      for (std::size_t i = 0; i < points.size(); ++i) {
        double expected = 0.0;
        for (int c = 0; c < lattice.nz; ++c) {
          for (int b = 0; b < lattice.ny; ++b) {
            for (int a = 0; a < lattice.nx; ++a) {
              // Nodes are multiples of the spacing in the world, to the last bit: they lie on voxel
              // faces, where rounding would pick another voxel.
              Eigen::Vector3d node =
                  (lattice.origin / lattice.spacing).array().round() + Eigen::Array3d(a, b, c);
              node *= lattice.spacing;
              if (!vertical) node.z() = lattice.origin.z();
              const Eigen::Vector3d d = (sensor - node) / lattice.spacing;
              const double w = basis(d.x()) * basis(d.y()) * (vertical ? basis(d.z()) : 1.0);
              if (w == 0.0 || (points[i] - node).norm() > options.max_range) continue;
              const VoxelGrid::Ray ray = grid.cast(node, points[i], options.trim);
              if (!ray.blocked) expected += w * std::exp(-options.attenuation * ray.unknown_length);
            }
          }
        }
        ASSERT_NEAR(p[i], expected, 1e-6) << n << " " << i;
      }
    }
  }
}

TEST(OcclusionTable, GradientIsThatOfTheValue) {
  std::mt19937_64 random(6);
  const VoxelGrid grid = test::hall(random, true);
  const auto points = surface_points(grid, 61, random);
  const std::size_t n = points.size();
  for (const bool vertical : {false, true}) {
    const OcclusionTable table(SensorLattice::around({0, 0, 0.8}, 1.0, 0.2, vertical), points, grid,
                               {});
    std::vector<double> p(n), plus(n), minus(n), d[3];
    for (auto& axis : d) axis.resize(n);
    int nonzero = 0;
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::Vector3d sensor(uniform(random, -1.5, 1.5), uniform(random, -1, 1),
                                   uniform(random, 0.2, 1.4));
      table.evaluate(sensor, p.data(), d[0].data(), d[1].data(), d[2].data());
      std::vector<double> value_only(n);
      table.evaluate(sensor, value_only.data());
      for (int a = 0; a < 3; ++a) {
        const double h = 1e-5;
        table.evaluate(sensor + h * Eigen::Vector3d::Unit(a), plus.data());
        table.evaluate(sensor - h * Eigen::Vector3d::Unit(a), minus.data());
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_NEAR(d[a][i], (plus[i] - minus[i]) / (2 * h), 2e-6) << a;
          ASSERT_NEAR(p[i], value_only[i], 1e-12);
          nonzero += d[a][i] != 0.0;
        }
      }
    }
    EXPECT_GT(nonzero, 300);
  }
}

TEST(OcclusionTable, TakingOverFromThePreviousTableChangesNothing) {
  std::mt19937_64 random(7);
  auto grid = std::make_shared<const VoxelGrid>(test::hall(random, true));
  std::vector<Eigen::Vector3d> points = surface_points(*grid, 120, random);
  std::unique_ptr<OcclusionTable> previous;
  Eigen::Vector3d center(0, 0, 0.45);
  std::int64_t scratch_rays = 0, reused_rays = 0;
  for (int step = 0; step < 12; ++step) {
    const SensorLattice lattice = SensorLattice::around(center, 1.5, 0.2);
    auto table = std::make_unique<OcclusionTable>(lattice, points, grid, OcclusionTable::Options(),
                                                  previous.get());
    const OcclusionTable scratch(lattice, points, *grid, {});
    EXPECT_EQ(table->rays_cast(), 0);
    std::vector<double> p(points.size()), q(points.size());
    for (int n = 0; n < 200; ++n) {
      const Eigen::Vector3d sensor =
          center + Eigen::Vector3d(uniform(random, -2, 2), uniform(random, -2, 2), 0);
      table->evaluate(sensor, p.data());
      scratch.evaluate(sensor, q.data());
      ASSERT_EQ(p, q) << "step " << step;
    }
    if (step > 0) {
      scratch_rays += scratch.rays_cast();
      reused_rays += table->rays_cast();
    }
    previous = std::move(table);
    // The robot moves, points come and go, and the map changes here and there (and grows once).
    center += Eigen::Vector3d(0.13, 0.07, 0);
    std::shuffle(points.begin(), points.end(), random);
    points.resize(110);
    for (const auto& p : surface_points(*grid, 10, random)) points.push_back(p);
    auto next = std::make_shared<VoxelGrid>(*grid);
    for (int m = 0; m < 3; ++m) {
      const int i = static_cast<int>(uniform(random, -60, 60)),
                j = static_cast<int>(uniform(random, -60, 60));
      for (int k = 2; k < 7; ++k) {
        next->set(
            i, j, k,
            next->state(i, j, k) == CellState::kFree ? CellState::kOccupied : CellState::kFree);
      }
    }
    if (step == 5) next->set(-100, 0, 3, CellState::kFree);
    grid = next;
  }
  std::printf("occlusion table: %.1f %% of rays cast anew\n",
              100.0 * static_cast<double>(reused_rays) / static_cast<double>(scratch_rays));
  EXPECT_LT(reused_rays, scratch_rays / 2);
}

TEST(OcclusionTable, CastsOnlyTheRaysThatAreAskedForAndEachOnce) {
  std::mt19937_64 random(8);
  const auto grid = std::make_shared<const VoxelGrid>(test::hall(random, true));
  const std::vector<Eigen::Vector3d> points = surface_points(*grid, 150, random);
  const SensorLattice lattice = SensorLattice::around({0, 0, 0.45}, 2.0, 0.2);
  const OcclusionTable all(lattice, points, *grid, {});
  const OcclusionTable table(lattice, points, grid, {}, nullptr);
  std::vector<double> p(points.size()), q(points.size());
  std::vector<float> s(points.size()), t(points.size());
  table.score({0.31, -0.52, 0.45}, s.data());
  all.score({0.31, -0.52, 0.45}, t.data());
  EXPECT_EQ(s, t);
  const std::int64_t once = table.rays_cast();
  EXPECT_GT(once, 0);
  EXPECT_LE(once, 9 * 150);
  table.evaluate({0.31, -0.52, 0.45}, p.data());
  EXPECT_EQ(table.rays_cast(), once);
  // Where it is asked everywhere, by several threads that come to the same rows at once.
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> seen(3);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    threads.emplace_back([&, k] {
      std::vector<double> out(points.size());
      for (double x = -2.3; x < 2.4; x += 0.1) {
        for (double y = -2.3; y < 2.4; y += 0.1) {
          table.evaluate({x, y, 0.45}, out.data());
          seen[k].insert(seen[k].end(), out.begin(), out.end());
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(table.rays_cast(), all.rays_cast());
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(seen[0], seen[2]);
  table.cast_all();
  EXPECT_EQ(table.rays_cast(), all.rays_cast());
  std::size_t at = 0;
  for (double x = -2.3; x < 2.4; x += 0.1) {
    for (double y = -2.3; y < 2.4; y += 0.1) {
      all.evaluate({x, y, 0.45}, q.data());
      for (const double value : q) ASSERT_EQ(value, seen[0][at++]) << x << ' ' << y;
    }
  }
}

TEST(OcclusionTable, StaysWithinBoundsOnDegenerateInput) {
  std::mt19937_64 random(8);
  const VoxelGrid unknown(GridFrame{0.1, -80, -80, 160, 160}, -0.1, 2.5);
  VoxelGrid solid(GridFrame{0.1, -20, -20, 40, 40}, -0.1, 1.0);
  for (int i = -20; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) {
      for (int k = -1; k < 10; ++k) solid.set(i, j, k, CellState::kOccupied);
    }
  }
  const VoxelGrid boxes = test::hall(random, true);
  for (const VoxelGrid* grid : {&unknown, static_cast<const VoxelGrid*>(&solid), &boxes}) {
    std::vector<Eigen::Vector3d> points = {{0, 0, 0.45}, {0.2, 0, 0.45}, {100, 0, 0}, {0, 0, -5}};
    for (int i = 0; i < 30; ++i) {
      points.emplace_back(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -1, 3));
    }
    for (const bool vertical : {false, true}) {
      const OcclusionTable table(SensorLattice::around({0, 0, 0.45}, 1.0, 0.2, vertical), points,
                                 *grid, {});
      const std::size_t n = points.size();
      std::vector<double> p(n), x(n), y(n), z(n);
      for (int trial = 0; trial < 100; ++trial) {
        Eigen::Vector3d sensor(uniform(random, -3, 3), uniform(random, -3, 3),
                               uniform(random, -1, 3));
        if (trial == 0) sensor = points[0];
        if (trial == 1) sensor = {1e12, -1e12, 1e12};
        table.evaluate(sensor, p.data(), x.data(), y.data(), z.data());
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_GE(p[i], 0.0);
          ASSERT_LE(p[i], 1.0 + 1e-12);
          ASSERT_TRUE(std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i]));
        }
      }
      table.evaluate({std::numeric_limits<double>::quiet_NaN(), 0, 0}, p.data(), x.data(),
                     y.data());
      EXPECT_TRUE(std::isnan(p[0]) && std::isnan(x[0]) && std::isnan(y[0]));
    }
  }
  // No points at all.
  const OcclusionTable none(SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), {}, boxes, {});
  none.evaluate({0, 0, 0.45}, nullptr);
  EXPECT_EQ(none.num_points(), 0);
}

TEST(OcclusionTable, RefusesWhatItCannotInterpolate) {
  const VoxelGrid grid(GridFrame{0.1, -8, -8, 16, 16}, 0.0, 1.0);
  EXPECT_THROW(OcclusionTable(SensorLattice(), {}, grid, {}), std::invalid_argument);
  SensorLattice lattice = SensorLattice::around({0, 0, 0}, 1.0, 0.2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(OcclusionTable(lattice, {{nan, 0, 0}}, grid, {}), std::invalid_argument);
  lattice.spacing = nan;
  EXPECT_THROW(OcclusionTable(lattice, {}, grid, {}), std::invalid_argument);
}

// A large lattice follows what there is to see, however far the sensor could get.
TEST(OcclusionTable, ALatticeAboutThePointsSeesTheSame) {
  std::mt19937_64 random(11);
  const VoxelGrid grid = test::hall(random, true);
  OcclusionTable::Options options;
  options.max_range = 2.0;
  for (const bool vertical : {false, true}) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 200; ++i) {
      points.emplace_back(uniform(random, 1, 3), uniform(random, -2, 0), uniform(random, 0, 1));
    }
    const Eigen::Vector3d center(0, 0, 0.8);
    const double reach = vertical ? 10.0 : 80.0;
    const SensorLattice all = SensorLattice::around(center, reach, 0.3, vertical);
    const SensorLattice some =
        SensorLattice::around(center, reach, 0.3, vertical, points, options.max_range);
    EXPECT_LT(10 * some.nx * some.ny * some.nz, all.nx * all.ny * all.nz);
    const auto shared = std::make_shared<const VoxelGrid>(grid);
    const OcclusionTable full(all, points, shared, options, nullptr);
    const OcclusionTable lean(some, points, shared, options, nullptr);
    std::vector<double> p(200), q(200), px(200), qx(200), py(200), qy(200);
    double seen = 0.0;
    for (int n = 0; n < 300; ++n) {
      const double far = n % 3 == 0 ? reach : 6.0;
      const Eigen::Vector3d sensor(uniform(random, -far, far), uniform(random, -far, far),
                                   vertical ? uniform(random, -far, far) : 0.8);
      full.evaluate(sensor, p.data(), px.data(), py.data());
      lean.evaluate(sensor, q.data(), qx.data(), qy.data());
      for (std::size_t i = 0; i < p.size(); ++i) {
        ASSERT_NEAR(p[i], q[i], 1e-12) << sensor.transpose();
        ASSERT_NEAR(px[i], qx[i], 1e-11) << sensor.transpose();
        ASSERT_NEAR(py[i], qy[i], 1e-11) << sensor.transpose();
        seen += p[i];
      }
    }
    EXPECT_GT(seen, 1.0);
    // Any reach, and points anywhere.
    for (const double far : {1e3, 1e9, 1e15}) {
      const SensorLattice wide =
          SensorLattice::around(center, far, 0.3, vertical, points, options.max_range);
      EXPECT_LT(wide.nx, 50);
      EXPECT_LT(wide.nz, 50);
      const SensorLattice away =
          SensorLattice::around(center, 1e3, 0.3, vertical, {{far, -far, far}}, options.max_range);
      EXPECT_GE(away.nx, 3);
      EXPECT_LT(away.nx, 50);
    }
    EXPECT_EQ(SensorLattice::around(center, 1e9, 0.3, vertical, {}, 2.0).ny, 27);
    // Many points far and wide: coarser.
    std::vector<Eigen::Vector3d> many;
    for (int i = 0; i < 20'000; ++i) {
      many.emplace_back(uniform(random, -200, 200), uniform(random, -200, 200), 0.5);
    }
    const SensorLattice coarse = SensorLattice::around(center, 1e3, 0.3, vertical, many, 2.0);
    EXPECT_LE(double{1} * coarse.nx * coarse.ny * coarse.nz * 20'008, SensorLattice::kMostEntries);
    EXPECT_GT(coarse.spacing, 0.5);
    EXPECT_NEAR(std::remainder(coarse.origin.x(), coarse.spacing), 0.0, 1e-6);
    // One of a usual size is as it was.
    const SensorLattice usual = SensorLattice::around(center, 5.0, 0.3, vertical, points, 2.0);
    EXPECT_EQ(usual.nx, SensorLattice::around(center, 5.0, 0.3, vertical).nx);
  }
}

}  // namespace
}  // namespace prospect::occlusion_table_test

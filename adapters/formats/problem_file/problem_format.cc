// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/problem_format.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "adapters/formats/problem_file/archive_knobs.h"
#include "engine/terms/builtin_terms.h"
#include "models/make_model.h"

namespace prospect {
namespace {

// Most that a problem may hold, so that no file makes its reader allocate gigabytes or work for
// hours. The largest problems that a configuration can ask for in earnest are far below.
constexpr std::size_t kMostVoxels = 200'000'000;
constexpr std::size_t kMostCells = 25'000'000;  // of the ground map and of the cost-to-go
constexpr std::size_t kMostLandmarks = 100'000;
constexpr std::size_t kMostTargets = 100'000;
constexpr std::size_t kMostBodyParts = 1000;
constexpr std::size_t kMostSeeds = 100'000;
constexpr std::size_t kMostCorners = 1000;  // of a zone
constexpr int kMostZones = 1000;            // of a kind
constexpr std::size_t kMostTerms = 1000;
constexpr std::size_t kMostMovers = 1000;
constexpr int kVersionWithoutZones = 2;
constexpr int kVersionWithoutAddedTerms = 3;
constexpr int kVersionWithoutScale = 4;
constexpr int kVersionWithoutMoreDepth = 5;
constexpr int kVersionWithoutMovers = 6;
constexpr double kMostTableEntries = 50e6;
constexpr double kMostRaySteps = 5e9;
constexpr int kMostStages = 1000;
constexpr double kFarthest = 1e6;  // [m]; beyond, addresses of cells could overflow
constexpr int kFarthestCell = 1'000'000'000;

/// The shape of a dataset that holds, for each of `count` elements, an array of shape `each`.
Archive::Shape shape_of_list(std::size_t count, const Archive::Shape& each) {
  Archive::Shape shape = {count};
  shape.insert(shape.end(), each.begin(), each.end());
  return shape;
}

/// A list has as many elements as the dataset `name` is long.
template <typename List>
void resize(Archive& a, const char* name, List& list, const Archive::Shape& each,
            std::size_t most) {
  std::size_t width = 1;
  for (const std::size_t n : each) width *= n;
  const Archive::Shape shape = a.shape(name, shape_of_list(list.size(), each), most * width);
  if (shape.front() > most) {
    a.refuse(name, "holds " + std::to_string(shape.front()), "at most " + std::to_string(most));
  }
  if (!a.writing()) list.resize(shape.front());
}

/// One member of the structures in a list, as a dataset: `entry(element, i)` refers to the i-th of
/// its numbers.
template <typename T, typename List, typename Entry>
void table(Archive& a, const char* name, List& list, const Archive::Shape& each, Entry entry) {
  std::size_t width = 1;
  for (const std::size_t n : each) width *= n;
  std::vector<T> values;
  if (a.writing()) {
    for (auto& element : list) {
      for (std::size_t i = 0; i < width; ++i) values.push_back(entry(element, i));
    }
  }
  a.array(name, values, shape_of_list(list.size(), each));
  for (std::size_t n = 0; n < list.size(); ++n) {
    for (std::size_t i = 0; i < width; ++i) entry(list[n], i) = values[n * width + i];
  }
}

Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

void origin(Archive& a, ProblemOrigin& o) {
  a.group("origin", [&] {
    a.text("program", o.program);
    a.text("world", o.world);
    a.natural("seed", o.seed);
    a.integer("step", o.step, 0, std::numeric_limits<int>::max());
    a.number("time", o.time);
  });
}

void motion(Archive& a, std::shared_ptr<const MotionModel>& model) {
  a.group("motion", [&] {
    std::string name = a.writing() ? std::string(model->name()) : "";
    a.text("model", name);
    ModelParameters parameters = a.writing() ? parameters_of(*model) : default_parameters(name);
    ArchiveKnobs knobs(a);
    describe(knobs, name, parameters);
    if (!a.writing()) model = make_model(name, parameters);
  });
}

void shape(Archive& a, RobotShape& shape) {
  a.group("shape", [&] {
    std::size_t kind = shape.index();
    a.choice("type", kind, {"spheres", "box", "cylinder", "convex"});
    if (!a.writing()) {
      const RobotShape kinds[] = {SphereSetShape(), BoxShape(), CylinderShape(), ConvexShape()};
      shape = kinds[kind];
    }
    if (auto* s = std::get_if<SphereSetShape>(&shape)) {
      resize(a, "center", s->spheres, {3}, kMostBodyParts);
      table<double>(a, "center", s->spheres, {3},
                    [](Sphere& e, std::size_t j) -> double& { return e.center[index(j)]; });
      table<double>(a, "radius", s->spheres, {},
                    [](Sphere& e, std::size_t) -> double& { return e.radius; });
    } else if (auto* b = std::get_if<BoxShape>(&shape)) {
      a.numbers("center", b->center.data(), {3});
      a.numbers("size", b->size.data(), {3});
    } else if (auto* c = std::get_if<CylinderShape>(&shape)) {
      a.numbers("center", c->center.data(), {3});
      a.number("radius", c->radius);
      a.number("height", c->height);
    } else if (auto* h = std::get_if<ConvexShape>(&shape)) {
      resize(a, "vertices", h->vertices, {3}, kMostBodyParts);
      table<double>(a, "vertices", h->vertices, {3},
                    [](Eigen::Vector3d& e, std::size_t j) -> double& { return e[index(j)]; });
    }
    if (!a.writing()) validate(shape);
  });
}

void mount(Archive& a, CameraMount& mount) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = mount.T_BC.matrix();
  a.numbers("T_BC", T.data(), {4, 4});
  if (a.writing()) return;
  if (T.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    a.refuse("T_BC", "has another last row", "0, 0, 0, 1");
  }
  mount.T_BC.matrix() = T;
  validate(mount);
}

/// Groups "1", "2" and so on.
template <typename List, typename Content>
void numbered(Archive& a, const char* name, List& list, Content content) {
  a.group(name, [&] {
    int count = static_cast<int>(list.size());
    a.integer("count", count, 0, kMostZones);
    if (!a.writing()) list.resize(static_cast<std::size_t>(count));
    for (int n = 0; n < count; ++n) {
      a.group(std::to_string(n + 1), [&] { content(list[static_cast<std::size_t>(n)]); });
    }
  });
}

void robot(Archive& a, int version, RobotDescription& r) {
  ArchiveKnobs knobs(a);
  a.group("robot", [&] {
    motion(a, r.model);
    shape(a, r.shape);
    a.group("stereo", [&] {
      describe(knobs, r.stereo);
      mount(a, r.stereo_mount);
    });
    a.group("depth", [&] {
      describe(knobs, r.depth);
      mount(a, r.depth_mount);
    });
    if (version <= kVersionWithoutMoreDepth) return;
    numbered(a, "more_depth", r.more_depth, [&](DepthSensor& sensor) {
      describe(knobs, sensor.footprint);
      mount(a, sensor.mount);
    });
  });
}

void horizon(Archive& a, ProblemSpecification& r) {
  a.group("horizon", [&] {
    a.integer("N", r.N, 1, kMostStages);
    a.integer("M", r.M, 1, r.N);
    a.number("dt", r.dt, 1e-6, 1e3);
    a.vector("x0", r.x0, r.robot.model->nx());
    a.vector("u_previous", r.u_previous, r.robot.model->nu());
  });
}

/// States of voxels or cells as bytes.
void states(Archive& a, const char* name, std::vector<CellState>& states,
            const Archive::Shape& shape) {
  std::vector<std::uint8_t> bytes;
  for (const CellState s : states) bytes.push_back(static_cast<std::uint8_t>(s));
  a.array(name, bytes, shape, static_cast<std::uint8_t>(CellState::kOccupied));
  states.clear();
  for (const std::uint8_t b : bytes) states.push_back(static_cast<CellState>(b));
}

Archive::Shape shape_of(const GridFrame& frame) {
  return {static_cast<std::size_t>(frame.height), static_cast<std::size_t>(frame.width)};
}

/// A rectangle of cells of the dataset `name`, whose first two dimensions are j and i; its lowest
/// cell is the attribute `origin`.
Archive::Shape frame(Archive& a, const char* name, const char* origin, GridFrame& frame,
                     Archive::Shape known, std::size_t most) {
  int lowest[] = {frame.i0, frame.j0};
  a.integers(origin, lowest, 2, -kFarthestCell, kFarthestCell);
  Archive::Shape shape = a.shape(name, known, most);
  for (const std::size_t n : shape) {
    if (n == 0) a.refuse(name, "is empty", "at least one cell");
  }
  // `most` keeps both within int.
  frame.i0 = lowest[0];
  frame.j0 = lowest[1];
  frame.height = static_cast<int>(shape[0]);
  frame.width = static_cast<int>(shape[1]);
  return shape;
}

void map(Archive& a, ProblemSpecification& r) {
  a.group("map", [&] {
    GridFrame columns, cells;
    int k0 = 0;
    std::size_t depth = 0;
    std::vector<CellState> voxels, ground;
    if (a.writing()) {
      columns = r.voxels->frame();
      k0 = r.voxels->k0();
      depth = static_cast<std::size_t>(r.voxels->depth());
      voxels = r.voxels->data();
      cells = r.ground->frame();
      ground = r.ground->cells().data;
      if (cells.resolution != columns.resolution) {
        a.refuse("resolution", "of voxels and ground differ", "the same");
      }
    }
    a.number("resolution", columns.resolution, 1e-3, 1e3);
    cells.resolution = columns.resolution;
    a.integer("lowest_layer", k0, -kFarthestCell, kFarthestCell);
    Archive::Shape all = shape_of(columns);
    all.push_back(depth);
    all = frame(a, "voxels", "voxels_origin", columns, all, kMostVoxels);
    states(a, "voxels", voxels, all);
    states(a, "ground", ground,
           frame(a, "ground", "ground_origin", cells, shape_of(cells), kMostCells));
    if (a.writing()) return;
    r.voxels =
        std::make_shared<const VoxelGrid>(columns, k0, static_cast<int>(all[2]), std::move(voxels));
    auto map = std::make_shared<GroundMap>(cells);
    for (int n = 0; n < cells.size(); ++n) {
      map->set(cells.at(n), ground[static_cast<std::size_t>(n)]);
    }
    r.ground = std::move(map);
  });
}

/// Sensor positions with rays to `points` points.
void sensor_lattice(Archive& a, SensorLattice& lattice, const OcclusionTable::Options& options,
                    std::size_t points, double resolution) {
  a.numbers("origin", lattice.origin.data(), {3});
  a.number("spacing", lattice.spacing, 1e-3, 1e3);
  int nodes[] = {lattice.nx, lattice.ny, lattice.nz};
  a.integers("nodes", nodes, 3, 1, 100'000);
  lattice.nx = nodes[0], lattice.ny = nodes[1], lattice.nz = nodes[2];
  for (int i = 0; i < 3; ++i) {
    const double end = lattice.origin[i] + lattice.spacing * (nodes[i] - 1);
    if (!(std::max(std::abs(lattice.origin[i]), std::abs(end)) <= kFarthest)) {
      a.refuse("", "the lattice reaches beyond 1000 km", "nodes within it");
    }
  }
  const double entries =
      static_cast<double>(nodes[0]) * nodes[1] * nodes[2] * static_cast<double>(points + 8);
  if (entries > kMostTableEntries || entries * options.max_range / resolution > kMostRaySteps) {
    a.refuse("",
             std::to_string(nodes[0]) + " x " + std::to_string(nodes[1]) + " x " +
                 std::to_string(nodes[2]) + " nodes with rays to " + std::to_string(points) +
                 " points within " + std::to_string(options.max_range) + " m",
             "at most 5e7 rays of 5e9 voxels in all");
  }
}

/// Sensor positions and the rays from there to `points` points.
void occlusion(Archive& a, SensorLattice& lattice, OcclusionTable::Options& options,
               std::size_t points, double resolution) {
  a.group("occlusion", [&] {
    a.number("trim", options.trim, 0.0);
    a.number("attenuation", options.attenuation, 0.0);
    a.number("max_range", options.max_range, 0.0, 1e4);
    sensor_lattice(a, lattice, options, points, resolution);
  });
}

void clearance_field(Archive& a, ProblemSpecification& r) {
  a.group("clearance_field", [&] {
    ClearanceField::Options& o = r.clearance_field;
    a.numbers("center", r.clearance_center.data(), {3});
    a.number("reach", o.reach, 0.0);
    a.number("cutoff", o.cutoff, 0.0, 1e4);
    a.number("margin", o.margin);
    a.flag("vertical", o.vertical);
    double slice[] = {o.slice.z_min, o.slice.z_max};
    a.numbers("slice", slice, {2});
    o.slice = {slice[0], slice[1]};
    a.number("vertical_reach", o.vertical_reach, 0.0, 1e4);
    // What is stored of the window follows the map (clearance_field.h).
    if (!ClearanceField::reaches(o.cutoff, r.voxels->resolution(), o.vertical)) {
      a.refuse("cutoff", "is " + std::to_string(o.cutoff) + " m",
               "1 to " +
                   std::to_string(o.vertical ? ClearanceField::kMostVoxelsInSpace
                                             : ClearanceField::kMostVoxels) +
                   " voxels");
    }
  });
}

void obstacle_terms(Archive& a, ProblemSpecification& r) {
  a.group("obstacles", [&] {
    a.number("weight", r.weights.obstacles);
    a.number("d_safe", r.d_safe);
    a.number("d_des", r.d_des);
  });
  a.group("clearance", [&] {
    a.number("d_safe", r.clearance.d_safe);
    a.number("floor", r.clearance.floor);
    a.number("slack", r.clearance.slack);
  });
  a.group("unknown_space", [&] {
    a.choice("policy", r.unknown, {"free", "blocked", "braking"});
    a.number("d_safe", r.unknown_d_safe);
  });
}

void landmarks(Archive& a, int version, std::vector<Landmark>& list) {
  a.group("landmarks", [&] {
    resize(a, "id", list, {}, kMostLandmarks);
    table<std::uint64_t>(a, "id", list, {},
                         [](Landmark& l, std::size_t) -> std::uint64_t& { return l.id; });
    table<double>(a, "position", list, {3},
                  [](Landmark& l, std::size_t j) -> double& { return l.position[index(j)]; });
    table<double>(a, "covariance", list, {3, 3}, [](Landmark& l, std::size_t j) -> double& {
      return l.covariance(index(j / 3), index(j % 3));
    });
    table<double>(a, "creation_direction", list, {3}, [](Landmark& l, std::size_t j) -> double& {
      return l.creation_direction[index(j)];
    });
    table<double>(a, "creation_range", list, {},
                  [](Landmark& l, std::size_t) -> double& { return l.creation_range; });
    table<double>(a, "survival", list, {},
                  [](Landmark& l, std::size_t) -> double& { return l.survival; });
    table<double>(a, "multiplicity", list, {},
                  [](Landmark& l, std::size_t) -> double& { return l.multiplicity; });
    if (version >= 2) {
      table<double>(a, "crowding", list, {},
                    [](Landmark& l, std::size_t) -> double& { return l.per_cell; });
    }
  });
}

void visible_features(Archive& a, int version, ProblemSpecification& r) {
  a.group("visible_features", [&] {
    a.number("weight", r.weights.visible_features);
    VisibleFeaturesParameters& f = r.features;
    ArchiveKnobs knobs(a);
    describe(knobs, f);
    a.number("chance_weight", f.chance_weight);
    a.number("rho", f.rho);
    knobs.group("visibility", [&] { describe(knobs, r.visibility); });
    knobs.group("odometry", [&] {
      OdometryNoise& odometry = r.visibility.odometry;
      if (version > kVersionWithoutScale) {
        describe(knobs, odometry);
      } else {
        describe_random_walk(knobs, odometry);
      }
    });
    landmarks(a, version, r.landmarks);
    occlusion(a, r.landmark_lattice, r.landmark_occlusion, r.landmarks.size(),
              r.voxels->resolution());
  });
}

void exploration_gain(Archive& a, int version, ProblemSpecification& r) {
  a.group("exploration_gain", [&] {
    a.number("weight", r.weights.exploration_gain);
    a.number("eta", r.gain.eta);
    a.number("tau", r.gain.tau);
    a.number("surface_per_area", r.gain.surface_per_area);
    a.number("angle_scale", r.gain.visibility.angle_scale);
    a.number("range_scale", r.gain.visibility.range_scale);
    a.number("inset", r.gain.visibility.inset);
    a.group("targets", [&] {
      std::vector<ExplorationTarget>& list = r.targets.targets;
      a.number("reference_area", r.targets.reference_area);
      a.integer("visible_now", r.targets.visible_now, 0, std::numeric_limits<int>::max());
      resize(a, "position", list, {3}, kMostTargets);
      table<double>(a, "position", list, {3}, [](ExplorationTarget& t, std::size_t j) -> double& {
        return t.position[index(j)];
      });
      table<double>(a, "mass", list, {},
                    [](ExplorationTarget& t, std::size_t) -> double& { return t.mass; });
    });
    occlusion(a, r.target_lattice, r.target_occlusion, r.targets.targets.size(),
              r.voxels->resolution());
    if (version <= kVersionWithoutMoreDepth) return;
    numbered(a, "more_depth", r.more_target_lattices, [&](SensorLattice& lattice) {
      sensor_lattice(a, lattice, r.target_occlusion, r.targets.targets.size(),
                     r.voxels->resolution());
    });
    if (r.more_target_lattices.size() != r.robot.more_depth.size()) {
      a.refuse("more_depth", "holds " + std::to_string(r.more_target_lattices.size()),
               "as many as /robot/more_depth");
    }
  });
}

void cost_to_go(Archive& a, ProblemSpecification& r) {
  a.group("cost_to_go", [&] {
    a.number("weight", r.weights.cost_to_go);
    Grid<double> seconds;
    std::vector<std::uint8_t> reached;
    double v_max = 0.0;
    if (a.writing()) {
      seconds = r.cost_to_go->cells();
      for (int n = 0; n < seconds.frame.size(); ++n) {
        reached.push_back(r.cost_to_go->reached(seconds.frame.at(n)) ? 1 : 0);
      }
      v_max = r.cost_to_go->v_max();
    }
    a.number("v_max", v_max);
    a.number("resolution", seconds.frame.resolution, 1e-3, 1e3);
    const Archive::Shape shape =
        frame(a, "seconds", "origin", seconds.frame, shape_of(seconds.frame), kMostCells);
    a.array("seconds", seconds.data, shape);
    a.array("reached", reached, shape, 1);
    if (a.writing()) return;
    Grid<std::uint8_t> flags(seconds.frame, 0);
    flags.data = std::move(reached);
    r.cost_to_go = std::make_shared<const CostToGo>(std::move(seconds), std::move(flags), v_max);
  });
}

void polygon(Archive& a, const char* name, Polygon& corners) {
  resize(a, name, corners, {2}, kMostCorners);
  table<double>(a, name, corners, {2},
                [](Eigen::Vector2d& p, std::size_t j) -> double& { return p[index(j)]; });
}

void zones(Archive& a, ProblemSpecification& r) {
  bool present = r.zones != nullptr;
  a.optional_group("zones", present, [&] {
    Zones z = a.writing() ? r.zones->zones() : Zones();
    bool bounded = z.bound.has_value();
    a.optional_group("bound", bounded, [&] {
      if (!z.bound) z.bound.emplace();
      polygon(a, "corners", *z.bound);
    });
    numbered(a, "keep_out", z.keep_out, [&](Polygon& area) { polygon(a, "corners", area); });
    numbered(a, "slow", z.slow, [&](SpeedZone& zone) {
      polygon(a, "corners", zone.area);
      a.number("max_speed", zone.max_speed);
    });
    if (a.writing()) return;
    if (const std::vector<std::string> wrong = faults(z); !wrong.empty()) {
      a.refuse("", wrong.front(), "zones that can be kept");
    }
    r.zones = std::make_shared<const ZoneMap>(std::move(z));
  });
}

void movers(Archive& a, std::vector<Mover>& list) {
  a.group("movers", [&] {
    resize(a, "position", list, {2}, kMostMovers);
    table<double>(a, "position", list, {2},
                  [](Mover& m, std::size_t j) -> double& { return m.position[index(j)]; });
    table<double>(a, "velocity", list, {2},
                  [](Mover& m, std::size_t j) -> double& { return m.velocity[index(j)]; });
    table<double>(a, "radius", list, {}, [](Mover& m, std::size_t) -> double& { return m.radius; });
    table<double>(a, "spread", list, {}, [](Mover& m, std::size_t) -> double& { return m.spread; });
    for (const Mover& m : list) {
      if (!m.sound()) a.refuse("radius", "or spread is negative or above 1e6", "0 to 1e6");
    }
  });
}

/// A term that is not built in: its name, version of options and options, by which a reader with
/// the same entry makes it again.
void added_term(Archive& a, const TermRegistry& registry, TermUse& use) {
  std::string name = a.writing() ? use.entry->name : "";
  a.text("name", name);
  int version = a.writing() ? use.entry->version : 0;
  a.integer("version", version, 1, std::numeric_limits<int>::max());
  if (!a.writing()) {
    try {
      use.entry = registry.find(name);
    } catch (const std::exception&) {
      a.refuse("name", "needs the term '" + name + "', which is not there",
               "the plug-in that brings it (--plugin)");
    }
    if (use.entry->version != version) {
      a.refuse("version",
               "has options of version " + std::to_string(version) + " of term '" + name + "'",
               "those of version " + std::to_string(use.entry->version) +
                   ", which the term at hand has");
    }
  }
  a.number("weight", use.weight, 0.0, TermEntry::kMostWeight);
  a.group("options", [&] {
    for (const TermOption& o : use.entry->options) {
      a.number(o.name.c_str(), use.options[o.name], o.least, o.most);
    }
  });
}

void added_terms(Archive& a, const TermRegistry& registry, ProblemSpecification& r) {
  a.group("added", [&] {
    numbered(a, "terms", r.added_terms, [&](TermUse& use) { added_term(a, registry, use); });
    const Archive::Shape shape = a.shape("left_out", {r.terms_left_out.size()}, kMostTerms);
    a.texts("left_out", r.terms_left_out, shape[0]);
    const TermRegistry known = builtin_terms();
    for (const std::string& name : r.terms_left_out) {
      try {
        known.find(name);
      } catch (const std::exception&) {
        a.refuse("left_out", "has '" + name + "'", "names of built-in terms");
      }
    }
  });
}

void terms(Archive& a, int version, const TermRegistry& registry, ProblemSpecification& r) {
  a.group("terms", [&] {
    a.group("control_effort", [&] {
      a.number("weight", r.weights.control_effort);
      a.vector("desired_input", r.desired_input, r.robot.model->nu());
    });
    a.group("input_rate", [&] { a.number("weight", r.weights.input_rate); });
    clearance_field(a, r);
    obstacle_terms(a, r);
    visible_features(a, version, r);
    exploration_gain(a, version, r);
    cost_to_go(a, r);
    a.group("heading_alignment", [&] { a.number("weight", r.weights.heading_alignment, 0.0); });
    if (version > kVersionWithoutAddedTerms) added_terms(a, registry, r);
  });
}

void seeds(Archive& a, SavedProblem& problem) {
  a.group("seeds", [&] {
    const auto M = static_cast<std::size_t>(problem.specification.M);
    const auto nu = static_cast<std::size_t>(problem.specification.robot.model->nu());
    std::vector<Seed>& list = problem.seeds;
    const Archive::Shape shape = a.shape("inputs", {list.size(), M, nu}, kMostSeeds * M * nu);
    if (shape[1] != M || shape[2] != nu) {
      a.refuse(
          "inputs",
          "has " + std::to_string(shape[1]) + " knots of " + std::to_string(shape[2]) + " inputs",
          std::to_string(M) + " of " + std::to_string(nu));
    }
    list.resize(shape[0]);
    std::vector<std::string> names;
    std::vector<double> inputs;
    for (const Seed& s : list) {
      names.push_back(s.name);
      if (a.writing() && s.z.size() != index(M * nu)) {
        a.refuse("inputs", "of seed '" + s.name + "' are " + std::to_string(s.z.size()),
                 std::to_string(M * nu));
      }
      inputs.insert(inputs.end(), s.z.data(), s.z.data() + s.z.size());
    }
    a.array("inputs", inputs, shape);
    a.texts("name", names, list.size());
    if (a.writing()) return;
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i].name = names[i];
      list[i].z = Eigen::Map<const Eigen::VectorXd>(inputs.data() + i * M * nu, index(M * nu));
    }
  });
}

/// A vector of `size` numbers, or empty, which means none.
void optional_vector(Archive& a, const char* name, Eigen::VectorXd& values, Eigen::Index size) {
  std::vector<double> data(values.data(), values.data() + values.size());
  const auto most = static_cast<std::size_t>(size);
  const Archive::Shape shape = a.shape(name, {data.size()}, most);
  if (shape[0] != 0 && shape[0] != most) {
    a.refuse(name, "has " + std::to_string(shape[0]) + " entries",
             std::to_string(most) + " or none");
  }
  a.array(name, data, shape);
  values = Eigen::Map<const Eigen::VectorXd>(data.data(), index(data.size()));
}

void warm_start(Archive& a, SavedProblem& problem) {
  bool present = problem.warm_start.has_value();
  a.optional_group("warm_start", present, [&] {
    if (!problem.warm_start) problem.warm_start.emplace();
    WarmStart& w = *problem.warm_start;
    const std::shared_ptr<const Problem> made = make_problem(problem.specification);
    optional_vector(a, "x", w.x, made->num_variables());
    optional_vector(a, "lambda", w.lambda, made->num_constraints());
    optional_vector(a, "z_lower", w.z_lower, made->num_variables());
    optional_vector(a, "z_upper", w.z_upper, made->num_variables());
    a.number("mu", w.mu, 0.0);
    a.number("time", w.time);
  });
}

}  // namespace

void transfer_problem(Archive& a, SavedProblem& problem, const TermRegistry& registry) {
  std::string format = "prospect problem";
  a.text("format", format);
  if (format != "prospect problem") {
    a.refuse("format", "is '" + format + "'", "'prospect problem'");
  }
  // The least that says it all: who knows no zones may read what has none.
  const ProblemSpecification& s = problem.specification;
  int version = !s.movers.empty()                                     ? kProblemFileVersion
                : !s.robot.more_depth.empty()                         ? kVersionWithoutMovers
                : s.visibility.odometry.scale > 0.0                   ? kVersionWithoutMoreDepth
                : !s.added_terms.empty() || !s.terms_left_out.empty() ? kVersionWithoutScale
                : s.zones                                             ? kVersionWithoutAddedTerms
                                                                      : kVersionWithoutZones;
  a.integer("version", version, 1, std::numeric_limits<int>::max());
  if (version > kProblemFileVersion) {
    a.refuse("version", "is " + std::to_string(version),
             "1 to " + std::to_string(kProblemFileVersion) + ", those that this program knows");
  }
  ProblemSpecification& r = problem.specification;
  origin(a, problem.origin);
  robot(a, version, r.robot);
  horizon(a, r);
  map(a, r);
  if (version > kVersionWithoutZones) zones(a, r);
  if (version > kVersionWithoutMovers) movers(a, r.movers);
  terms(a, version, registry, r);
  seeds(a, problem);
  warm_start(a, problem);
}

}  // namespace prospect

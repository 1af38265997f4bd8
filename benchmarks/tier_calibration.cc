// SPDX-License-Identifier: Apache-2.0
// tier_calibration --out DIR [--worlds LIST] [--seeds N] [--first-seed N] [--length L]
//                  [--sensors model|camera|both|none] [--set KEY=VALUE...]
// The kinematic tier against the camera tier on the same true paths. A tour drives from place to
// place, drawn from the seed among all that the robot gets to, with no regard for what it sees:
// turning on the spot towards a place that lies beside or behind, at 0.5 m/s and 0.8 rad/s at most.
// The tour depends on world and seed alone, so both tiers see from the same poses at the same
// times, and a tier that is changed is driven on the same path. Only people, whom cameras meet, may
// stop it: such a tour is left out.
//
// Each drive becomes a table of images, DIR/WORLD_SEED_SENSORS.csv; those that are there already
// are not driven again. Then, over all worlds and seeds asked for of which both tables are there:
//   tracked      points tracked in an image, while not lost: median and quartiles
//   < 20, < 10   share of images with fewer [%]
//   lost         losses per 100 m driven, and share of the time lost [%]
//   drift        over pieces of 2 m of the path in which neither tier was lost: median and root
//                mean square of the relative position error [mm/m], and of the heading error
//                [mrad/m]. For long after a loss the fusion with wheels pays back what the wheels
//                erred by then, on turns and in jumps: the median leaves that out, the mean square
//                does not
//   all          root mean square of the position error over all pieces of 5 m, lost or not [mm/m]
// and the ratio of the kinematic tier to the camera tier of each, with the 95 % interval of a
// bootstrap over blocks of 10 m of path, which both tiers share.
//
// At last, of each drive in both tiers, what its errors have in common while it is not lost, by
// least squares over all images: of the length of motions [%], of their direction in the body
// [mrad], and of turns [%]; with their root mean square over drives. Same arguments, same numbers.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/simulator.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/tour.h"
#include "models/range_text.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr double kPeriod = 0.1;  // [s] of images and commands

struct Row {
  double path = 0.0;  // [m] driven so far
  Pose true_pose, estimate;
  int tracked = 0;
  bool lost = false;
};
using Drive = std::vector<Row>;

struct Arguments {
  std::vector<std::string> worlds;
  int seeds = 2, first_seed = 1;
  double length = 60.0;  // [m]
  std::string sensors = "both", out;
  std::vector<std::string> settings;
};

std::string table_of(const Arguments& a, const std::string& world, int seed,
                     const std::string& sensors) {
  std::string name = fs::exists(world) ? fs::path(world).stem().string() : world;
  std::replace(name.begin(), name.end(), ':', '_');
  return (fs::path(a.out) / (name + "_" + std::to_string(seed) + "_" + sensors + ".csv")).string();
}

void drive(const Arguments& a, const std::string& name, int seed, const std::string& sensors) {
  const std::string file = table_of(a, name, seed, sensors);
  if (fs::exists(file)) return;
  std::vector<YamlSetting> settings = {"simulator.sensors=" + sensors};
  for (const std::string& setting : a.settings) settings.emplace_back(setting);
  const Configuration configuration = configuration_from_text("", "the defaults", {}, settings);
  const auto world =
      std::make_shared<const World>(load_world(name, world_options_for(configuration)));
  SimulatorOptions options = configuration.simulator;
  options.seed = static_cast<std::uint64_t>(seed);
  Simulator simulator(world, options, configuration.perception);
  Tour tour(roomy_columns(*world, configuration), static_cast<std::uint64_t>(seed));
  std::ostringstream rows;
  rows << "path,x,y,yaw,estimated_x,estimated_y,estimated_yaw,tracked,lost\n";
  // Not for ever, should the robot stand.
  const double limit = 20.0 * a.length;
  while (simulator.path_length() < a.length && simulator.time() < limit) {
    simulator.apply(tour.command(simulator.true_pose()), kPeriod);
    const auto belief = simulator.sense();
    const Pose pose = simulator.true_pose();
    rows << exact_text(simulator.path_length()) << ',' << exact_text(pose.position.x()) << ','
         << exact_text(pose.position.y()) << ',' << exact_text(pose.yaw) << ','
         << exact_text(belief->pose.position.x()) << ',' << exact_text(belief->pose.position.y())
         << ',' << exact_text(belief->pose.yaw) << ',' << belief->tracked_features << ','
         << (belief->localization == Localization::kLost) << '\n';
  }
  std::ofstream out(file);
  out << rows.str();
  if (!out) throw InputError(file + ": cannot be written");
  const double off = simulator.localization_error();
  std::fprintf(stderr, "%s: %.0f s, %.1f m, %d losses, %d contacts, ends %.3f m off, %.2f %%\n",
               file.c_str(), simulator.time(), simulator.path_length(), simulator.losses(),
               simulator.collisions(), off, 100.0 * off / simulator.path_length());
}

Drive read(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  Drive drive;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream values(line);
    Row r;
    int lost = 0;
    values >> r.path >> r.true_pose.position.x() >> r.true_pose.position.y() >> r.true_pose.yaw >>
        r.estimate.position.x() >> r.estimate.position.y() >> r.estimate.yaw >> r.tracked >> lost;
    if (!values) throw InputError(file + ": expected rows of nine numbers");
    r.lost = lost != 0;
    drive.push_back(r);
  }
  return drive;
}

/// Sums of one tier over one block of path.
struct Sums {
  double path = 0.0, images = 0.0, below_20 = 0.0, below_10 = 0.0, lost = 0.0, losses = 0.0;
  double pieces = 0.0, position = 0.0, heading = 0.0;  // squares per square metre
  double all_pieces = 0.0, all_position = 0.0;
  std::vector<double> tracked, positions, headings;

  void add(const Sums& s) {
    path += s.path;
    images += s.images;
    below_20 += s.below_20;
    below_10 += s.below_10;
    lost += s.lost;
    losses += s.losses;
    pieces += s.pieces;
    position += s.position;
    heading += s.heading;
    all_pieces += s.all_pieces;
    all_position += s.all_position;
    tracked.insert(tracked.end(), s.tracked.begin(), s.tracked.end());
    positions.insert(positions.end(), s.positions.begin(), s.positions.end());
    headings.insert(headings.end(), s.headings.begin(), s.headings.end());
  }
};
struct Block {
  Sums camera, model;
};

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return std::nan("");
  const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[static_cast<std::size_t>(n)];
}

/// From one pose to another, in the frame of the first [m].
Eigen::Vector2d motion(const Pose& a, const Pose& b) {
  return Eigen::Rotation2Dd(-a.yaw) * (b.position - a.position).head<2>();
}

/// Squares of the position [m^2] and heading [rad^2] error of the motion from one row to another.
std::pair<double, double> squared_error(const Row& from, const Row& to) {
  const Eigen::Vector2d e =
      motion(from.estimate, to.estimate) - motion(from.true_pose, to.true_pose);
  const double turn = std::remainder(
      to.estimate.yaw - from.estimate.yaw - (to.true_pose.yaw - from.true_pose.yaw), 2.0 * M_PI);
  return {e.squaredNorm(), turn * turn};
}

void add_pieces(const Drive& camera, const Drive& model, std::vector<Block>& blocks,
                std::size_t first) {
  constexpr double kPiece = 2.0, kLongPiece = 5.0, kStep = 0.5;
  const auto block = [&](const Row& r) -> Block& {
    return blocks[first + static_cast<std::size_t>(r.path / 10.0)];
  };
  std::vector<int> lost_before(camera.size() + 1, 0);
  for (std::size_t n = 0; n < camera.size(); ++n) {
    lost_before[n + 1] = lost_before[n] + (camera[n].lost || model[n].lost);
  }
  double next = 0.0;
  std::size_t end = 0, long_end = 0;
  for (std::size_t n = 0; n < camera.size(); ++n) {
    if (camera[n].path < next) continue;
    next = camera[n].path + kStep;
    const auto from = [&](std::size_t& e, double length) {
      while (e < camera.size() && camera[e].path < camera[n].path + length) ++e;
      return e < camera.size();
    };
    Block& b = block(camera[n]);
    if (from(end, kPiece) && lost_before[end + 1] == lost_before[n]) {
      const auto enter = [&](Sums& tier, const std::pair<double, double>& squares) {
        tier.pieces += 1.0;
        tier.position += squares.first / (kPiece * kPiece);
        tier.heading += squares.second / (kPiece * kPiece);
        tier.positions.push_back(std::sqrt(squares.first) / kPiece);
        tier.headings.push_back(std::sqrt(squares.second) / kPiece);
      };
      enter(b.camera, squared_error(camera[n], camera[end]));
      enter(b.model, squared_error(model[n], model[end]));
    }
    if (from(long_end, kLongPiece)) {
      const double scale = 1.0 / (kLongPiece * kLongPiece);
      b.camera.all_pieces += 1.0;
      b.model.all_pieces += 1.0;
      b.camera.all_position += scale * squared_error(camera[n], camera[long_end]).first;
      b.model.all_position += scale * squared_error(model[n], model[long_end]).first;
    }
  }
}

void add_images(const Drive& drive, Sums Block::*tier, std::vector<Block>& blocks,
                std::size_t first) {
  bool was_lost = false;
  double path = 0.0;
  for (const Row& r : drive) {
    Sums& s = blocks[first + static_cast<std::size_t>(r.path / 10.0)].*tier;
    s.path += r.path - path;
    path = r.path;
    s.images += 1.0;
    s.below_20 += r.tracked < 20;
    s.below_10 += r.tracked < 10;
    s.lost += r.lost;
    s.losses += r.lost && !was_lost;
    if (!r.lost) s.tracked.push_back(r.tracked);
    was_lost = r.lost;
  }
}

/// What the errors of a drive have in common: (scale, direction [rad], turn [share]).
Eigen::Vector3d lasting_errors(const Drive& drive) {
  double along = 0.0, across = 0.0, way = 0.0, turn = 0.0, turned = 0.0;
  for (std::size_t n = 1; n < drive.size(); ++n) {
    const Row &from = drive[n - 1], &to = drive[n];
    if (from.lost || to.lost) continue;
    const Eigen::Vector2d d = motion(from.true_pose, to.true_pose);
    const Eigen::Vector2d e = motion(from.estimate, to.estimate) - d;
    const double a = std::remainder(to.true_pose.yaw - from.true_pose.yaw, 2.0 * M_PI);
    const double estimated = std::remainder(to.estimate.yaw - from.estimate.yaw, 2.0 * M_PI);
    along += d.dot(e);
    across += d.x() * e.y() - d.y() * e.x();
    way += d.squaredNorm();
    turn += a * (estimated - a);
    turned += a * a;
  }
  return {along / way, across / way, turn / turned};
}

struct Lasting {
  std::string drive;
  Eigen::Vector3d camera, model;
};

void report(const std::vector<Lasting>& drives) {
  const Eigen::Array3d unit(100.0, 1e3, 100.0);
  Eigen::Array3d camera = Eigen::Array3d::Zero(), model = camera;
  const auto print = [&](const std::string& name, const Eigen::Array3d& c,
                         const Eigen::Array3d& m) {
    const Eigen::Array3d of_camera = unit * c, of_model = unit * m;
    std::printf("  %-24s %8.3f %8.2f %8.3f   %8.3f %8.2f %8.3f\n", name.c_str(), of_camera[0],
                of_camera[1], of_camera[2], of_model[0], of_model[1], of_model[2]);
  };
  std::printf("in common, scale [%%], direction [mrad], turn [%%]: camera, model\n");
  for (const Lasting& l : drives) {
    print(l.drive, l.camera, l.model);
    camera += l.camera.array().square() / static_cast<double>(drives.size());
    model += l.model.array().square() / static_cast<double>(drives.size());
  }
  print("root mean square", camera.sqrt(), model.sqrt());
}

void add(const Drive& camera, const Drive& model, std::vector<Block>& blocks) {
  if (camera.empty()) throw InputError("a table of no images");
  const std::size_t first = blocks.size();
  blocks.resize(first + static_cast<std::size_t>(camera.back().path / 10.0) + 1);
  add_images(camera, &Block::camera, blocks, first);
  add_images(model, &Block::model, blocks, first);
  add_pieces(camera, model, blocks, first);
}

struct Measure {
  const char* name;
  std::function<double(Sums&)> value;
};
const std::vector<Measure>& measures() {
  static const std::vector<Measure> all = {
      {"tracked, median", [](Sums& s) { return quantile(s.tracked, 0.5); }},
      {"tracked, quarter", [](Sums& s) { return quantile(s.tracked, 0.25); }},
      {"tracked, three quarters", [](Sums& s) { return quantile(s.tracked, 0.75); }},
      {"images with < 20 [%]", [](Sums& s) { return 100.0 * s.below_20 / s.images; }},
      {"images with < 10 [%]", [](Sums& s) { return 100.0 * s.below_10 / s.images; }},
      {"losses per 100 m", [](Sums& s) { return 100.0 * s.losses / s.path; }},
      {"time lost [%]", [](Sums& s) { return 100.0 * s.lost / s.images; }},
      {"drift, median [mm/m]", [](Sums& s) { return 1e3 * quantile(s.positions, 0.5); }},
      {"drift, RMS", [](Sums& s) { return 1e3 * std::sqrt(s.position / s.pieces); }},
      {"heading, median [mrad/m]", [](Sums& s) { return 1e3 * quantile(s.headings, 0.5); }},
      {"heading, RMS", [](Sums& s) { return 1e3 * std::sqrt(s.heading / s.pieces); }},
      {"all, 5 m, RMS [mm/m]",
       [](Sums& s) { return 1e3 * std::sqrt(s.all_position / s.all_pieces); }},
  };
  return all;
}

void report(const std::string& name, const std::vector<Block>& blocks) {
  const std::size_t count = measures().size();
  const auto sums = [&](const auto& pick) {
    Block total;
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      const Block& b = blocks[pick(n)];
      total.camera.add(b.camera);
      total.model.add(b.model);
    }
    return total;
  };
  Block total = sums([](std::size_t n) { return n; });
  std::vector<std::vector<double>> ratios(count);
  std::mt19937 generator(1);
  constexpr int kResamples = 1000;
  for (int k = 0; k < kResamples; ++k) {
    Block sample = sums([&](std::size_t) { return generator() % blocks.size(); });
    for (std::size_t m = 0; m < count; ++m) {
      const double ratio = measures()[m].value(sample.model) / measures()[m].value(sample.camera);
      if (std::isfinite(ratio)) ratios[m].push_back(ratio);
    }
  }
  std::printf("%s, %.0f m\n", name.c_str(), total.camera.path);
  for (std::size_t m = 0; m < count; ++m) {
    const double camera = measures()[m].value(total.camera);
    const double model = measures()[m].value(total.model);
    std::printf("  %-24s %8.2f %8.2f", measures()[m].name, camera, model);
    std::vector<double>& r = ratios[m];
    if (!r.empty() && camera > 0.0) {
      std::sort(r.begin(), r.end());
      const auto at = [&](double share) {
        return r[static_cast<std::size_t>(share * static_cast<double>(r.size() - 1))];
      };
      std::printf("   %5.2f [%.2f, %.2f]", model / camera, at(0.025), at(0.975));
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

int main_program(int argc, char** argv) {
  Arguments a;
  ProgramOptions options("The kinematic tier against the camera tier, on the same paths");
  options.add("--worlds", a.worlds, "as `prospect explore` takes them", {.commas = true});
  options.add("--seeds", a.seeds, "how many", {.least = 1, .most = 1000});
  options.add("--first-seed", a.first_seed, "the first of them", {.least = 1, .most = 100000});
  options.add("--length", a.length, "of a tour [m]", {.least = 5.0, .most = 1e5});
  options.add("--sensors", a.sensors,
              "which drives: model, camera, both; none: only the tables that are there",
              {.one_of = {"model", "camera", "both", "none"}});
  options.add("--set", a.settings, "KEY=VALUE of the configuration, in a folder of its own");
  options.add("--out", a.out, "folder of the tables", {.required = true});
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  if (a.worlds.empty()) a.worlds = {"office", "loop", "plan:1", "plan:4"};
  fs::create_directories(a.out);
  for (int seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed) {
    for (const std::string& world : a.worlds) {
      for (const char* sensors : {"model", "camera"}) {
        if (a.sensors == "both" || a.sensors == sensors) drive(a, world, seed, sensors);
      }
    }
  }
  std::printf("%-26s %8s %8s   %s\n", "", "camera", "model", "model / camera [95 %]");
  std::vector<Block> everything;
  std::vector<Lasting> lasting;
  for (const std::string& world : a.worlds) {
    std::vector<Block> blocks;
    for (int seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed) {
      const std::string camera = table_of(a, world, seed, "camera");
      const std::string model = table_of(a, world, seed, "model");
      if (!fs::exists(camera) || !fs::exists(model)) continue;
      const Drive by_camera = read(camera), by_model = read(model);
      if (by_camera.size() != by_model.size()) {
        std::printf("%s: left out, somebody stood in the way\n", camera.c_str());
        continue;
      }
      add(by_camera, by_model, blocks);
      lasting.push_back(
          {fs::path(camera).stem().string(), lasting_errors(by_camera), lasting_errors(by_model)});
    }
    if (blocks.empty()) continue;
    report(world, blocks);
    everything.insert(everything.end(), blocks.begin(), blocks.end());
  }
  if (a.worlds.size() > 1 && !everything.empty()) report("all", everything);
  if (!lasting.empty()) report(lasting);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("tier_calibration", prospect::main_program, argc, argv);
}

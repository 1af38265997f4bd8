// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/problem_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <set>
#include <sstream>
#include <thread>

#include "models/unicycle.h"
#include "tests/engine/problem_specifications.h"
#include "tests/engine/same_problem.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::test::problem_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

SavedProblem saved(const NamedSpecification& named) {
  return {{"prospect 1.2.3", named.name, 0xFEDCBA9876543210u, 17, 8.5},
          *named.specification,
          named.seeds,
          std::nullopt};
}

/// A problem that is quick to make and small to store.
SavedProblem small_problem() {
  PlannerParameters p;
  p.N = 8;
  p.M = 4;
  p.visibility.r_max = 2.0;
  p.max_targets = 20;
  p.weights.heading_alignment = 0.1;
  return saved(specification_of("small", "unicycle", p, 40));
}

class ProblemFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = ::testing::TempDir() + "problem_file_" + std::to_string(getpid());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  std::string path(const std::string& name) const { return root_ + "/" + name; }

  /// What reading says, without the path that it must begin with; empty if it says nothing.
  static std::string refused(const std::string& file) {
    try {
      read_problem(file);
    } catch (const std::invalid_argument& e) {
      const std::string message = e.what();
      EXPECT_THAT(message, StartsWith(file + ": "));
      EXPECT_THAT(message, HasSubstr("; expected "));
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), file.size() + 300) << message;
      return message.substr(std::min(message.size(), file.size() + 2));
    }
    return "";
  }
  /// What writing says, and that it leaves nothing.
  std::string not_written(const SavedProblem& problem) const {
    const std::string file = path("not written.h5");
    try {
      write_problem(file, problem);
    } catch (const std::invalid_argument& e) {
      EXPECT_FALSE(fs::exists(file));
      EXPECT_FALSE(fs::exists(file + ".part"));
      EXPECT_THAT(e.what(), StartsWith(file + ": cannot be written: "));
      return std::string(e.what()).substr(file.size() + 21);
    }
    return "";
  }

  std::string root_;
};

TEST_F(ProblemFileTest, AProblemReadBackIsTheOneThatWasWrittenBitForBit) {
  NOT_UNDER_SANITIZERS("the release build compares bits");
  for (const NamedSpecification& named : specifications_of_every_kind()) {
    SCOPED_TRACE(named.name);
    const std::string file = path("problem.h5");
    const SavedProblem before = saved(named);
    write_problem(file, before);
    EXPECT_FALSE(fs::exists(file + ".part"));
    const ReadProblem after = read_problem(file);
    ASSERT_NE(after.problem, nullptr);
    // Against the problem that the planner really had, which knows nothing of specifications or
    // files.
    expect_same_problem(*named.problem, *after.problem);

    EXPECT_EQ(after.saved.origin.program, "prospect 1.2.3");
    EXPECT_EQ(after.saved.origin.world, named.name);
    EXPECT_EQ(after.saved.origin.seed, 0xFEDCBA9876543210u);
    EXPECT_EQ(after.saved.origin.step, 17);
    EXPECT_EQ(after.saved.origin.time, 8.5);
    EXPECT_FALSE(after.saved.warm_start);
    ASSERT_EQ(after.saved.seeds.size(), before.seeds.size());
    ASSERT_FALSE(before.seeds.empty());
    for (std::size_t i = 0; i < before.seeds.size(); ++i) {
      EXPECT_EQ(after.saved.seeds[i].name, before.seeds[i].name);
      EXPECT_EQ(bits(after.saved.seeds[i].z), bits(before.seeds[i].z));
    }

    // Written once more it has the same bytes: nothing was lost, nor changed.
    write_problem(path("again.h5"), after.saved);
    EXPECT_EQ(content(file), content(path("again.h5")));
  }
}

TEST_F(ProblemFileTest, KeepsAWarmStartAndWhatElseMayBeThereOrNot) {
  SavedProblem problem = small_problem();
  const std::shared_ptr<const Problem> made = make_problem(problem.specification);
  problem.warm_start.emplace();
  WarmStart& w = *problem.warm_start;
  w.x = problem.seeds.front().z;
  w.lambda = Eigen::VectorXd::LinSpaced(made->num_constraints(), 0.0, 1.0);
  w.mu = 1e-3;
  w.time = 12.25;
  problem.seeds.clear();
  problem.origin = {};
  write_problem(path("a.h5"), problem);
  const SavedProblem read = read_problem(path("a.h5")).saved;
  ASSERT_TRUE(read.warm_start);
  EXPECT_EQ(bits(read.warm_start->x), bits(w.x));
  EXPECT_EQ(bits(read.warm_start->lambda), bits(w.lambda));
  EXPECT_EQ(read.warm_start->z_lower.size(), 0);
  EXPECT_EQ(read.warm_start->mu, 1e-3);
  EXPECT_EQ(read.warm_start->time, 12.25);
  EXPECT_TRUE(read.seeds.empty());
  EXPECT_EQ(read.origin.world, "");

  w.z_upper = Eigen::VectorXd::Zero(3);
  EXPECT_EQ(not_written(problem), "/warm_start/z_upper: has 3 entries; expected 8 or none");
}

TEST_F(ProblemFileTest, TheSameProblemGivesTheSameBytesAndFewOfThem) {
  const SavedProblem problem = small_problem();
  write_problem(path("a.h5"), problem);
  sleep(1);  // a time that is stored would show
  write_problem(path("b.h5"), problem);
  EXPECT_EQ(content(path("a.h5")), content(path("b.h5")));

  // The whole default problem: up to 300 landmarks and 200 targets.
  write_problem(path("full.h5"), saved(specification_of("full", "unicycle", {}, 2000)));
  const ReadProblem full = read_problem(path("full.h5"));
  EXPECT_GT(full.saved.specification.landmarks.size(), 200u);
  EXPECT_LE(full.saved.specification.landmarks.size(), 300u);
  EXPECT_LT(fs::file_size(path("full.h5")), 200'000u);
}

TEST_F(ProblemFileTest, TakesOddNames) {
  SavedProblem problem = small_problem();
  problem.origin.world = "world\nof \xff\xfe bytes";
  problem.origin.program = std::string(10000, 'x');
  problem.seeds.front().name = "";
  problem.seeds.back().name = std::string("a\0b", 3);
  write_problem(path("a.h5"), problem);
  const SavedProblem read = read_problem(path("a.h5")).saved;
  EXPECT_EQ(read.origin.world, problem.origin.world);
  EXPECT_EQ(read.origin.program, std::string(4096, 'x'));
  EXPECT_EQ(read.seeds.front().name, "");
  EXPECT_EQ(read.seeds.back().name, "a");
}

/// A model that make_model() does not know.
class OwnModel final : public MotionModel {
 public:
  std::string_view name() const override { return "hovercraft"; }
  int nx() const override { return base_.nx(); }
  int nu() const override { return base_.nu(); }
  void step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& u,
            double dt, Eigen::Ref<Eigen::VectorXd> next) const override {
    base_.step(x, u, dt, next);
  }
  void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                 Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const override {
    base_.jacobians(x, u, dt, A, B);
  }
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>& u,
                  double dt, Eigen::Ref<BatchArray> next) const override {
    base_.step_batch(x, u, dt, next);
  }
  const InputLimits& limits() const override { return base_.limits(); }
  PoseLayout pose_layout() const override { return base_.pose_layout(); }
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
              const Eigen::Ref<const Eigen::VectorXd>& u) const override {
    return base_.twist(x, u);
  }
  Eigen::VectorXd state(const Pose& pose, const Twist& twist) const override {
    return base_.state(pose, twist);
  }
  Eigen::VectorXd input(const Twist& twist) const override { return base_.input(twist); }
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& previous,
                                double dt) const override {
    return base_.braking_input(x, previous, dt);
  }
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                       Eigen::VectorXd* d_u) const override {
    return base_.squared_speed(x, u, d_x, d_u);
  }
  double max_speed() const override { return base_.max_speed(); }
  double max_yaw_rate() const override { return base_.max_yaw_rate(); }
  double max_deceleration() const override { return base_.max_deceleration(); }

 private:
  Unicycle base_;
};

TEST_F(ProblemFileTest, RefusesToWriteWhatItCouldNotRead) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const SavedProblem sound = small_problem();
  const auto with = [&](auto change) {
    SavedProblem problem = sound;
    change(problem);
    return not_written(problem);
  };
  EXPECT_THAT(with([](auto& p) { p.specification.robot.model = std::make_shared<OwnModel>(); }),
              HasSubstr("unknown motion model 'hovercraft'"));
  EXPECT_THAT(with([](auto& p) { p.specification.robot.model = nullptr; }), HasSubstr("expected"));
  EXPECT_THAT(with([](auto& p) { p.specification.voxels = nullptr; }),
              HasSubstr("no voxels; expected"));
  EXPECT_THAT(with([](auto& p) { p.specification.cost_to_go = nullptr; }), HasSubstr("expected"));
  EXPECT_THAT(with([](auto& p) { p.specification.weights.obstacles = kNan; }),
              HasSubstr("/terms/obstacles/weight: is nan; expected a number from"));
  EXPECT_THAT(with([](auto& p) { p.specification.gain.tau = kInfinity; }),
              HasSubstr("/terms/exploration_gain/tau: is inf; expected"));
  EXPECT_THAT(with([](auto& p) { p.specification.x0[1] = kNan; }),
              HasSubstr("/horizon/x0: is nan"));
  EXPECT_THAT(with([](auto& p) { p.specification.x0.setZero(7); }),
              HasSubstr("/horizon/x0: has 7 entries; expected 3"));
  EXPECT_THAT(with([](auto& p) { p.specification.landmarks[3].position.z() = kNan; }),
              HasSubstr("/terms/visible_features/landmarks/position: is nan"));
  EXPECT_THAT(with([](auto& p) { p.specification.M = 9; }),
              HasSubstr("/horizon/M: is 9; expected a whole number from 1 to 8"));
  EXPECT_THAT(with([](auto& p) { p.specification.N = 100000; }),
              HasSubstr("/horizon/N: is 100000"));
  EXPECT_THAT(with([](auto& p) { p.origin.step = -1; }), HasSubstr("/origin/step: is -1"));
  EXPECT_THAT(with([](auto& p) { p.seeds[1].z.setZero(3); }), HasSubstr("/seeds/inputs: of seed"));
  EXPECT_THAT(with([](auto& p) { p.seeds[1].z[0] = kNan; }), HasSubstr("/seeds/inputs: is nan"));
  EXPECT_THAT(with([](auto& p) { p.specification.landmark_lattice.nx = 100000; }),
              HasSubstr("/terms/visible_features/occlusion: 100000 x"));
  EXPECT_THAT(with([](auto& p) { p.specification.clearance_field.cutoff = 50.0; }),
              HasSubstr("/terms/clearance_field/cutoff: is 50.000000 m; expected 1 to 400 voxels"));
  EXPECT_EQ(with([](auto& p) { p.specification.clearance_field.reach = 1e9; }), "");
  EXPECT_EQ(with([](auto&) {}), "");
}

TEST_F(ProblemFileTest, RefusesWhatNoSolverCouldBeginWith) {
  // Each number is within its bounds; what they make together is not.
  const auto with = [&](auto change) {
    SavedProblem problem = small_problem();
    change(problem.specification);
    write_problem(path("hostile.h5"), problem);
    return refused(path("hostile.h5"));
  };
  for (const double place : {1e9, -1e9, 2147483647.0}) {
    EXPECT_THAT(
        with([&](ProblemSpecification& r) { r.x0[0] = place; }),
        HasSubstr("its terms are no finite numbers at any of its seeds (visible_features)"));
  }
  EXPECT_EQ(with([](auto&) {}), "");
}

TEST_F(ProblemFileTest, SaysWhyAFileCannotBeWrittenAndLeavesTheOldOne) {
  const SavedProblem problem = small_problem();
  const auto failure = [&](const std::string& file) -> std::string {
    try {
      write_problem(file, problem);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(failure(path("no/such/folder.h5")),
            path("no/such/folder.h5") + ": writing failed (No such file or directory)");
  fs::create_directories(path("folder.h5/inside"));
  EXPECT_THAT(failure(path("folder.h5")), StartsWith(path("folder.h5") + ": writing failed ("));
  EXPECT_FALSE(fs::exists(path("folder.h5.part")));
  // A disk that is full, for files.
  std::ofstream(path("old.h5")) << "precious";
  fs::create_symlink("/dev/full", path("old.h5.part"));
  EXPECT_EQ(failure(path("old.h5")), path("old.h5") + ": writing failed (No space left on device)");
  EXPECT_EQ(content(path("old.h5")), "precious");
  EXPECT_EQ(failure(path("sound.h5")), "");
  EXPECT_EQ(failure(path("sound.h5")), "");  // again, over itself
  EXPECT_EQ(refused(path("sound.h5")), "");
}

TEST_F(ProblemFileTest, SaysWhatAFileIsThatIsNoProblem) {
  EXPECT_EQ(refused(path("nothing.h5")), "no such file; expected a problem file");
  EXPECT_EQ(refused(path("no/thing.h5")), "no such file; expected a problem file");
  EXPECT_EQ(refused(root_), "is a directory; expected a problem file");
  std::ofstream(path("empty.h5")).flush();
  EXPECT_EQ(refused(path("empty.h5")), "empty file; expected a problem file");
  std::ofstream(path("text.h5")) << "step,time\n0,0\n";
  EXPECT_EQ(refused(path("text.h5")), "no HDF5 file; expected a problem file");
  std::ofstream(path("zeros.h5")) << std::string(100000, '\0');
  EXPECT_EQ(refused(path("zeros.h5")), "no HDF5 file; expected a problem file");
  EXPECT_EQ(refused(std::string(PROSPECT_SOURCE_DIR) + "/docs/images/report.png"),
            "no HDF5 file; expected a problem file");
  // HDF5 files of others, of the oldest and of the newest format.
  for (const bool newest : {false, true}) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (newest) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const hid_t f = H5Fcreate(path("other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    H5Gclose(H5Gcreate2(f, "map", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Pclose(access);
    H5Fclose(f);
    EXPECT_EQ(refused(path("other.h5")),
              "/format: missing; expected a text of a fixed length, at most 4096 bytes");
  }
  std::ofstream(path("signature.h5")) << "\x89HDF\r\n\x1a\n";
  EXPECT_THAT(refused(path("signature.h5")), StartsWith("damaged or truncated ("));
  ASSERT_EQ(mkfifo(path("fifo.h5").c_str(), 0600), 0);
  EXPECT_EQ(refused(path("fifo.h5")), "is no regular file; expected a problem file");
  std::ofstream(path("large.h5")).flush();
  fs::resize_file(path("large.h5"), std::uintmax_t{1} << 40);  // sparse
  EXPECT_EQ(refused(path("large.h5")),
            "1099511627776 bytes; expected a problem file, at most 1 GiB");
  try {
    read_problem(path("line\nbreak.h5"));
    ADD_FAILURE();
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

/// Changes a file as another program might, through HDF5.
void edit(const std::string& file, const std::function<void(hid_t)>& change) {
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(f, 0);
  change(f);
  ASSERT_GE(H5Fclose(f), 0);
}

/// Puts a dataset of double in the place of another one; 0 in all its elements.
void replace(hid_t f, const char* name, const std::vector<hsize_t>& dims, hid_t type,
             const std::function<void(hid_t)>& creation = {}) {
  ASSERT_GE(H5Ldelete(f, name, H5P_DEFAULT), 0) << name;
  const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
  const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
  if (creation) creation(plist);
  const hid_t d = H5Dcreate2(f, name, type, space, H5P_DEFAULT, plist, H5P_DEFAULT);
  ASSERT_GE(d, 0) << name;
  H5Dclose(d);
  H5Pclose(plist);
  H5Sclose(space);
}

template <typename T>
void set_attribute(hid_t f, const char* group, const char* name, hid_t file_type, hid_t memory_type,
                   const std::vector<T>& values, bool scalar = true) {
  const hid_t g = H5Gopen2(f, group, H5P_DEFAULT);
  ASSERT_GE(g, 0) << group;
  if (H5Aexists(g, name) > 0) H5Adelete(g, name);
  const hsize_t size = values.size();
  const hid_t space = scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr);
  const hid_t a = H5Acreate2(g, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(a, memory_type, values.data()), 0);
  H5Aclose(a);
  H5Sclose(space);
  H5Gclose(g);
}

void set_number(hid_t f, const char* group, const char* name, double value) {
  set_attribute<double>(f, group, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {value});
}
void set_integer(hid_t f, const char* group, const char* name, std::int64_t value) {
  set_attribute<std::int64_t>(f, group, name, H5T_STD_I64LE, H5T_NATIVE_INT64, {value});
}
void set_integers(hid_t f, const char* group, const char* name,
                  const std::vector<std::int64_t>& values) {
  set_attribute<std::int64_t>(f, group, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values, false);
}
void set_text(hid_t f, const char* group, const char* name, const std::string& value) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, value.size() + 1);
  set_attribute<char>(f, group, name, type, type,
                      {value.c_str(), value.c_str() + value.size() + 1});
  H5Tclose(type);
}

TEST_F(ProblemFileTest, SaysWhichEntryIsNoneOfAProblemWhateverItClaims) {
  const std::string original = path("original.h5");
  write_problem(original, small_problem());
  const auto after = [&](const std::function<void(hid_t)>& change) {
    const std::string file = path("edited.h5");
    fs::copy_file(original, file, fs::copy_options::overwrite_existing);
    edit(file, change);
    return refused(file);
  };
  const std::string cells = "/terms/cost_to_go/seconds";

  // Not ours, not this version.
  EXPECT_EQ(after([](hid_t f) { H5Adelete(f, "format"); }),
            "/format: missing; expected a text of a fixed length, at most 4096 bytes");
  EXPECT_EQ(after([](hid_t f) { set_text(f, "/", "format", "prospect map"); }),
            "/format: is 'prospect map'; expected 'prospect problem'");
  EXPECT_EQ(after([](hid_t f) { set_integer(f, "/", "version", 8); }),
            "/version: is 8; expected 1 to 7, those that this program knows");
  EXPECT_THAT(after([](hid_t f) { set_integer(f, "/", "version", -1); }),
              StartsWith("/version: is -1; expected"));
  EXPECT_THAT(
      after([](hid_t f) { set_number(f, "/", "version", 1.0); }),
      StartsWith("/version: has another type or shape; expected an attribute of type int64"));

  // Missing, or of another type or shape.
  EXPECT_EQ(after([](hid_t f) { H5Ldelete(f, "/terms/obstacles", H5P_DEFAULT); }),
            "/terms/obstacles: missing; expected a group");
  EXPECT_EQ(after([](hid_t f) { H5Ldelete(f, "/map/voxels", H5P_DEFAULT); }),
            "/map/voxels: missing; expected a dataset of 3 dimensions");
  EXPECT_EQ(after([](hid_t f) {
              const hid_t g = H5Gopen2(f, "/robot/motion", H5P_DEFAULT);
              H5Adelete(g, "v_max");
              H5Gclose(g);
            }),
            "/robot/motion/v_max: missing; expected an attribute of type float64");
  EXPECT_EQ(after([](hid_t f) { set_integer(f, "/horizon", "dt", 1); }),
            "/horizon/dt: has another type or shape; expected an attribute of type float64");
  EXPECT_EQ(after([](hid_t f) {
              set_integers(f, "/horizon", "N", {8, 8});
            }),
            "/horizon/N: has another type or shape; expected an attribute of type int64");
  EXPECT_EQ(after([](hid_t f) {
              set_integers(f, "/map", "voxels_origin", {1, 2, 3});
            }),
            "/map/voxels_origin: has another type or shape; expected an attribute of type "
            "int64[2]");
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/map/ground", {16, 16}, H5T_IEEE_F64LE);
              }),
              StartsWith("/map/ground: has another type or shape; expected a dataset of type "
                         "uint8[16, 16]"));
  EXPECT_EQ(after([](hid_t f) { replace(f, "/map/ground", {16}, H5T_STD_U8LE); }),
            "/map/ground: has 1 dimensions; expected 2");
  EXPECT_EQ(after([](hid_t f) {
              replace(f, "/map/ground", {16, 0}, H5T_STD_U8LE);
            }),
            "/map/ground: is empty; expected at least one cell");
  EXPECT_THAT(after([&](hid_t f) {
                replace(f, "/terms/cost_to_go/reached", {3, 4}, H5T_STD_U8LE);
              }),
              StartsWith("/terms/cost_to_go/reached: has another type or shape; expected"));
  EXPECT_THAT(
      after([](hid_t f) {
        replace(f, "/terms/visible_features/landmarks/survival", {3}, H5T_IEEE_F64LE);
      }),
      StartsWith(
          "/terms/visible_features/landmarks/survival: has another type or shape; expected"));
  EXPECT_THAT(after([](hid_t f) {
                const hid_t type = H5Tcopy(H5T_C_S1);
                H5Tset_size(type, H5T_VARIABLE);
                replace(f, "/seeds/name", {3}, type);
                H5Tclose(type);
              }),
              StartsWith("/seeds/name: has another type or shape; expected"));
  EXPECT_THAT(after([](hid_t f) {
                const hid_t type = H5Tcopy(H5T_C_S1);
                H5Tset_size(type, H5T_VARIABLE);
                set_attribute<const char*>(f, "/robot/motion", "model", type, type, {"unicycle"});
                H5Tclose(type);
              }),
              StartsWith("/robot/motion/model: has another type or shape; expected"));
  EXPECT_THAT(after([](hid_t f) { set_text(f, "/", "format", std::string(5000, 'x')); }),
              StartsWith("/format: has another type or shape; expected"));
  EXPECT_THAT(after([](hid_t f) {
                H5Ldelete(f, "/map/ground", H5P_DEFAULT);
                H5Gclose(H5Gcreate2(f, "/map/ground", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
              }),
              StartsWith("/map/ground: damaged ("));
  EXPECT_THAT(after([](hid_t f) {
                H5Ldelete(f, "/terms", H5P_DEFAULT);
                H5Lcreate_hard(f, "/map/ground", f, "/terms", H5P_DEFAULT, H5P_DEFAULT);
              }),
              StartsWith("/terms: damaged ("));

  // Values that no problem has.
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(after([](hid_t f) { set_number(f, "/terms/obstacles", "weight", kNan); }),
            "/terms/obstacles/weight: is nan; expected a number from -1e+12 to 1e+12");
  EXPECT_THAT(after([](hid_t f) { set_text(f, "/robot/motion", "model", "bicycle"); }),
              StartsWith("unknown motion model 'bicycle'"));
  EXPECT_EQ(after([](hid_t f) { set_text(f, "/terms/unknown_space", "policy", "ignored"); }),
            "/terms/unknown_space/policy: is 'ignored'; expected one of: free, blocked, braking");
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/robot/motion", "v_max", -1.0); }),
              HasSubstr("v_max"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/robot/shape", "radius", 0.0); }),
              HasSubstr("radius"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/robot/stereo", "fx", -3.0); }), HasSubstr("fx"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/terms/exploration_gain", "eta", 1.5); }),
              StartsWith("exploration gain: eta is 1.5"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/terms/clearance", "slack", -1.0); }),
              HasSubstr("slack"));
  EXPECT_THAT(after([](hid_t f) { set_integer(f, "/terms/clearance_field", "vertical", 2); }),
              StartsWith("/terms/clearance_field/vertical: is 2"));
  for (const double value : {kNan, 1e300, -std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(after([&](hid_t f) {
                  const hid_t d = H5Dopen2(f, cells.c_str(), H5P_DEFAULT);
                  const hid_t space = H5Dget_space(d);
                  std::vector<double> all(
                      static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), 1.0);
                  all[17] = value;
                  H5Dwrite(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
                  H5Sclose(space);
                  H5Dclose(d);
                }),
                StartsWith(cells + ": is "));
  }
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/map/ground", {4, 4}, H5T_STD_U8LE, [](hid_t plist) {
                  const std::uint8_t three = 3;
                  H5Pset_fill_value(plist, H5T_NATIVE_UINT8, &three);
                });
              }),
              StartsWith("/map/ground: holds 3; expected values from 0 to 2"));

  // Sizes that would fill the memory: a file may claim them without having them.
  const auto chunked = [](hid_t plist) {
    const hsize_t chunk[] = {1, 1, 1000};
    H5Pset_chunk(plist, 3, chunk);
  };
  EXPECT_EQ(after([&](hid_t f) {
              replace(f, "/map/voxels", {1000000, 1000000, 1000}, H5T_STD_U8LE, chunked);
            }),
            "/map/voxels: holds 1000000 x 1000000 x 1000 elements; expected at most 200000000");
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/map/voxels", {4000000000, 4000000000, 2}, H5T_STD_U8LE,
                        [](hid_t plist) {
                          const hsize_t chunk[] = {1, 1, 2};
                          H5Pset_chunk(plist, 3, chunk);
                        });
              }),
              StartsWith("/map/voxels: holds 4000000000 x 4000000000 x 2 elements"));
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/terms/visible_features/landmarks/id", {1000000000}, H5T_STD_U64LE,
                        [](hid_t plist) {
                          const hsize_t chunk = 1000;
                          H5Pset_chunk(plist, 1, &chunk);
                        });
              }),
              StartsWith("/terms/visible_features/landmarks/id: holds 1000000000 elements"));
  EXPECT_THAT(
      after([](hid_t f) {
        replace(f, "/terms/exploration_gain/targets/position", {1000000000000, 0}, H5T_IEEE_F64LE);
      }),
      StartsWith("/terms/exploration_gain/targets/position: "));
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/seeds/inputs", {1000000000000, 0, 0}, H5T_IEEE_F64LE);
              }),
              StartsWith("/seeds/inputs: has 0 knots of 0 inputs; expected 4 of 2"));
  EXPECT_THAT(after([](hid_t f) { set_integer(f, "/horizon", "N", 100000); }),
              StartsWith("/horizon/N: is 100000"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/terms/clearance_field", "cutoff", 1e4); }),
              HasSubstr("/terms/clearance_field/cutoff: is 10000.000000 m; expected 1 to 400"));
  EXPECT_THAT(after([](hid_t f) { set_number(f, "/map", "resolution", 0.001); }),
              HasSubstr("expected 1 to 400 voxels"));
  EXPECT_THAT(after([](hid_t f) {
                set_integers(f, "/terms/visible_features/occlusion", "nodes", {9999, 9999, 1});
              }),
              HasSubstr("9999 x 9999 x 1 nodes with rays to"));
  // Few rays, but they could run for minutes.
  EXPECT_THAT(after([](hid_t f) {
                set_integers(f, "/terms/visible_features/occlusion", "nodes", {300, 300, 1});
                set_number(f, "/terms/visible_features/occlusion", "max_range", 2000.0);
              }),
              HasSubstr("points within 2000.000000 m; expected at most 5e7 rays of 5e9 voxels"));
  EXPECT_THAT(after([](hid_t f) {
                set_integers(f, "/terms/visible_features/occlusion", "nodes", {-1, 3, 1});
              }),
              StartsWith("/terms/visible_features/occlusion/nodes: holds -1; expected"));
  EXPECT_THAT(after([](hid_t f) {
                set_number(f, "/terms/exploration_gain/occlusion", "spacing", 1000.0);
                set_integers(f, "/terms/exploration_gain/occlusion", "nodes", {3, 3000, 1});
              }),
              HasSubstr("reaches beyond 1000 km"));

  // Data that lie elsewhere, or are stored in ways that nobody needs.
  std::ofstream(path("elsewhere")) << std::string(1 << 20, 'x');
  EXPECT_THAT(after([&](hid_t f) {
                replace(f, "/map/ground", {16, 16}, H5T_STD_U8LE, [&](hid_t plist) {
                  H5Pset_external(plist, path("elsewhere").c_str(), 0, 256);
                });
              }),
              StartsWith("/map/ground: lies in another file; expected"));
  EXPECT_THAT(after([&](hid_t f) {
                replace(f, "/map/ground", {16, 16}, H5T_STD_U8LE, [&](hid_t plist) {
                  const hsize_t dims[] = {16, 16};
                  const hid_t space = H5Screate_simple(2, dims, nullptr);
                  H5Pset_virtual(plist, space, original.c_str(), "/map/ground", space);
                  H5Sclose(space);
                });
              }),
              StartsWith("/map/ground: is stored in an unusual way; expected"));
  EXPECT_EQ(after([&](hid_t f) {
              H5Ldelete(f, "/map/ground", H5P_DEFAULT);
              H5Lcreate_external(original.c_str(), "/map/ground", f, "/map/ground", H5P_DEFAULT,
                                 H5P_DEFAULT);
            }),
            "/map/ground: missing; expected a dataset of 2 dimensions");
  EXPECT_EQ(after([&](hid_t f) {
              H5Ldelete(f, "/terms", H5P_DEFAULT);
              H5Lcreate_soft("/map", f, "/terms", H5P_DEFAULT, H5P_DEFAULT);
            }),
            "/terms: missing; expected a group");
  EXPECT_THAT(after([](hid_t f) {
                replace(f, "/map/ground", {64, 64}, H5T_STD_U8LE, [](hid_t plist) {
                  const hsize_t chunk[] = {64, 64};
                  H5Pset_chunk(plist, 2, chunk);
                  H5Pset_scaleoffset(plist, H5Z_SO_INT, 2);
                });
              }),
              StartsWith("/map/ground: has a filter other than shuffle, deflate and fletcher32"));

  // Notes do no harm; what a problem does not have is not dropped in silence.
  EXPECT_EQ(after([](hid_t f) {
              set_text(f, "/map", "note", "by hand");
              H5Gclose(H5Gcreate2(f, "/notes", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
            }),
            "");
  const auto not_read = [](const std::string& name) {
    return name +
           ": not read; expected what a problem of its version, model and shape has; notes "
           "are called note...";
  };
  const auto group = [](hid_t f, const char* name) {
    H5Gclose(H5Gcreate2(f, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  };
  EXPECT_EQ(after([&](hid_t f) { group(f, "/zone"); }), not_read("/zone"));
  EXPECT_EQ(after([&](hid_t f) { group(f, "/zones"); }), not_read("/zones"));  // of version 3
  EXPECT_EQ(after([&](hid_t f) { group(f, "/terms/own"); }), not_read("/terms/own"));
  EXPECT_EQ(after([](hid_t f) { set_number(f, "/robot/motion", "vz_max", 1.0); }),
            not_read("/robot/motion/vz_max"));
  EXPECT_EQ(after([](hid_t f) { set_number(f, "/terms/obstacles", "weigth", 1.0); }),
            not_read("/terms/obstacles/weigth"));
}

/// Each entry of a file, by its place.
std::vector<std::string> entries(hid_t f) {
  std::vector<std::string> names;
  struct Collects {
    std::vector<std::string>& names;
    std::string group;
  };
  const auto object = [](hid_t root, const char* name, const H5O_info_t* info, void* to) -> herr_t {
    auto& all = *static_cast<std::vector<std::string>*>(to);
    const std::string place = name == std::string(".") ? "" : "/" + std::string(name);
    if (info->type == H5O_TYPE_DATASET) {
      all.push_back(place);
      return 0;
    }
    Collects collects{all, place};
    const hid_t g = H5Gopen2(root, place.empty() ? "/" : place.c_str(), H5P_DEFAULT);
    H5Aiterate2(
        g, H5_INDEX_NAME, H5_ITER_INC, nullptr,
        [](hid_t, const char* attribute, const H5A_info_t*, void* its) -> herr_t {
          auto& its_group = *static_cast<Collects*>(its);
          its_group.names.push_back(its_group.group + "@" + attribute);
          return 0;
        },
        &collects);
    H5Gclose(g);
    return 0;
  };
  H5Ovisit(f, H5_INDEX_NAME, H5_ITER_INC, object, &names);
  return names;
}

/// Another value of an element of an entry, a hair away: one amid a map, whose rim may be cut, the
/// first of a text; false if it has none.
template <typename Read, typename Write>
bool alter(hid_t type, hid_t space, Read read, Write write) {
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  const std::size_t size = H5Tget_size(type);
  std::vector<char> bytes(count * size);
  if (bytes.empty()) return false;
  read(bytes.data());
  std::size_t at = 0;
  hsize_t dims[H5S_MAX_RANK] = {};
  const int rank = H5Sget_simple_extent_dims(space, dims, nullptr);
  std::size_t under = 1;  // elements below an index of the dimension
  for (int n = rank - 1; n >= 0 && H5Tget_class(type) != H5T_STRING; --n) {
    at += dims[n] / 2 * under;
    under *= dims[n];
  }
  at *= size;
  if (H5Tget_class(type) == H5T_FLOAT) {
    double value = 0.0;
    std::memcpy(&value, &bytes[at], sizeof value);
    value = value == 0.0 ? 1e-3 : value * 1.001;
    std::memcpy(&bytes[at], &value, sizeof value);
  } else {
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
  }
  write(bytes.data());
  return true;
}

// Whatever is in a file, another value of it is read, and written again, or refused.
TEST_F(ProblemFileTest, UsesOrRefusesEachEntry) {
  SavedProblem problem = small_problem();
  Zones zones;
  zones.bound = Polygon{{-50, -50}, {50, -50}, {50, 50}, {-50, 50}};
  zones.keep_out = {{{20, 20}, {21, 20}, {21, 21}}};
  zones.slow = {{{{-1, -1}, {0, -1}, {0, 0.1}}, 0.3}};
  problem.specification.zones = std::make_shared<const ZoneMap>(zones);
  problem.specification.visibility.odometry.scale = 0.01;
  problem.warm_start.emplace();
  problem.warm_start->x = problem.seeds.front().z;
  const std::string original = path("original.h5"), file = path("altered.h5");
  write_problem(original, problem);
  std::vector<std::string> all;
  edit(original, [&](hid_t f) { all = entries(f); });
  ASSERT_GT(all.size(), 140u);
  std::size_t used = 0;
  for (const std::string& name : all) {
    SCOPED_TRACE(name);
    fs::copy_file(original, file, fs::copy_options::overwrite_existing);
    bool altered = false;
    edit(file, [&](hid_t f) {
      const std::size_t at = name.find('@');
      if (at != std::string::npos) {
        const std::string group = at == 0 ? "/" : name.substr(0, at);
        const char* const attribute = name.c_str() + at + 1;
        const hid_t g = H5Gopen2(f, group.c_str(), H5P_DEFAULT);
        const hid_t a = H5Aopen(g, attribute, H5P_DEFAULT);
        const hid_t type = H5Aget_type(a), space = H5Aget_space(a);
        altered = alter(
            type, space, [&](char* to) { H5Aread(a, type, to); },
            [&](const char* from) {
              H5Adelete(g, attribute);
              const hid_t other = H5Acreate2(g, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT);
              ASSERT_GE(H5Awrite(other, type, from), 0);
              H5Aclose(other);
            });
        H5Sclose(space);
        H5Tclose(type);
        H5Aclose(a);
        H5Gclose(g);
      } else {
        const hid_t d = H5Dopen2(f, name.c_str(), H5P_DEFAULT);
        const hid_t type = H5Dget_type(d), space = H5Dget_space(d);
        altered = alter(
            type, space, [&](char* to) { H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); },
            [&](const char* from) { H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, from); });
        H5Sclose(space);
        H5Tclose(type);
        H5Dclose(d);
      }
    });
    if (!altered) continue;
    try {
      const ReadProblem read = read_problem(file);
      write_problem(path("again.h5"), read.saved);
      EXPECT_FALSE(content(path("again.h5")) == content(original)) << "is not read";
      ++used;
    } catch (const std::invalid_argument&) {
    }
  }
  EXPECT_GT(used, all.size() / 2);
}

TEST_F(ProblemFileTest, ReadsWhatAnotherProgramHasStoredInItsOwnWay) {
  const SavedProblem problem = small_problem();
  write_problem(path("a.h5"), problem);
  // Copied into a file of the oldest format of HDF5, without compression and checksums.
  const hid_t from = H5Fopen(path("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t to = H5Fcreate(path("b.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  for (const char* name : {"origin", "robot", "horizon", "map", "terms", "seeds"}) {
    ASSERT_GE(H5Ocopy(from, name, to, name, H5P_DEFAULT, H5P_DEFAULT), 0);
  }
  set_text(to, "/", "format", "prospect problem");
  set_integer(to, "/", "version", 2);
  const hid_t d = H5Dopen2(from, "/terms/cost_to_go/seconds", H5P_DEFAULT);
  const hid_t space = H5Dget_space(d);
  hsize_t dims[2];
  H5Sget_simple_extent_dims(space, dims, nullptr);
  std::vector<double> values(dims[0] * dims[1]);
  H5Dread(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(d);
  H5Sclose(space);
  replace(to, "/terms/cost_to_go/seconds", {dims[0], dims[1]}, H5T_IEEE_F64LE);
  const hid_t plain = H5Dopen2(to, "/terms/cost_to_go/seconds", H5P_DEFAULT);
  H5Dwrite(plain, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(plain);
  H5Fclose(to);
  H5Fclose(from);
  ASSERT_NE(content(path("a.h5")), content(path("b.h5")));
  expect_same_problem(*make_problem(problem.specification), *read_problem(path("b.h5")).problem);
}

// Version 1 knew of no crowded image cells.
TEST_F(ProblemFileTest, ReadsVersionOne) {
  SavedProblem problem = small_problem();
  for (Landmark& l : problem.specification.landmarks) l.per_cell = 0.3;
  write_problem(path("two.h5"), problem);
  expect_same_problem(*make_problem(problem.specification), *read_problem(path("two.h5")).problem);
  for (Landmark& l : problem.specification.landmarks) l.per_cell = 0.0;
  write_problem(path("one.h5"), problem);
  edit(path("one.h5"), [](hid_t f) {
    set_integer(f, "/", "version", 1);
    H5Ldelete(f, "/terms/visible_features/landmarks/crowding", H5P_DEFAULT);
  });
  expect_same_problem(*make_problem(problem.specification), *read_problem(path("one.h5")).problem);
  edit(path("one.h5"), [](hid_t f) { set_integer(f, "/", "version", 2); });
  EXPECT_THAT(refused(path("one.h5")),
              StartsWith("/terms/visible_features/landmarks/crowding: missing; expected"));
}

// Zones are what version 3 has; a file without them is one of version 2, which programs read that
// know of none.
TEST_F(ProblemFileTest, KeepsZonesToTheBit) {
  SavedProblem problem = small_problem();
  write_problem(path("two.h5"), problem);
  edit(path("two.h5"), [](hid_t f) { set_integer(f, "/", "version", 3); });
  EXPECT_EQ(read_problem(path("two.h5")).saved.specification.zones, nullptr);
  Zones zones;
  zones.keep_out = {{{0.1, 0.2}, {1.0 / 3.0, 0.2}, {0.3, 0.9}}, {{2, 2}, {3, 2}, {3, 3}, {2, 3}}};
  zones.slow = {{{{-1, -1}, {0, -1}, {0, 0.1}}, 0.1 + 0.2}};
  problem.specification.zones = std::make_shared<const ZoneMap>(zones);
  problem.seeds.clear();
  write_problem(path("three.h5"), problem);
  const ReadProblem read = read_problem(path("three.h5"));
  ASSERT_NE(read.saved.specification.zones, nullptr);
  const Zones& back = read.saved.specification.zones->zones();
  EXPECT_FALSE(back.bound);
  EXPECT_EQ(back.keep_out, zones.keep_out);
  ASSERT_EQ(back.slow.size(), 1u);
  EXPECT_EQ(back.slow[0].area, zones.slow[0].area);
  EXPECT_EQ(back.slow[0].max_speed, 0.1 + 0.2);
  expect_same_problem(*make_problem(problem.specification), *read.problem);
  ASSERT_NE(read.problem->definition().zones, nullptr);
  edit(path("three.h5"), [](hid_t f) { set_number(f, "/zones/slow/1", "max_speed", -1.0); });
  EXPECT_THAT(refused(path("three.h5")), StartsWith("/zones: slow[0]: max_speed is -1"));
}

// An error of the odometry's scale is what version 5 has.
TEST_F(ProblemFileTest, KeepsTheErrorOfTheScale) {
  SavedProblem problem = small_problem();
  problem.specification.visibility.odometry.scale = 0.1 / 3.0;
  write_problem(path("five.h5"), problem);
  const ReadProblem read = read_problem(path("five.h5"));
  EXPECT_EQ(read.saved.specification.visibility.odometry.scale, 0.1 / 3.0);
  expect_same_problem(*make_problem(problem.specification), *read.problem);
  edit(path("five.h5"), [](hid_t f) { set_integer(f, "/", "version", 4); });
  EXPECT_THAT(refused(path("five.h5")),
              StartsWith("/terms/visible_features/odometry/scale: not read; expected"));
}

TEST_F(ProblemFileTest, LeavesTheSettingsOfHdf5AsTheyWere) {
  static int printed = 0;
  const auto print = [](hid_t, void*) -> herr_t {
    ++printed;
    return 0;
  };
  H5E_auto2_t old = nullptr;
  void* old_data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &old, &old_data);
  H5Eset_auto2(H5E_DEFAULT, print, nullptr);
  write_problem(path("a.h5"), small_problem());
  std::string bytes = content(path("a.h5"));
  for (const std::size_t at : {std::size_t{20}, bytes.size() / 2}) {
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    std::ofstream(path("b.h5"), std::ios::binary) << bytes;
    EXPECT_NE(refused(path("b.h5")), "");
  }
  EXPECT_EQ(printed, 0);
  EXPECT_LT(H5Fopen(path("none").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), 0);
  EXPECT_EQ(printed, 1);
  H5Eset_auto2(H5E_DEFAULT, old, old_data);
}

TEST_F(ProblemFileTest, SeveralThreadsMayReadAndWrite) {
  hbool_t safe = false;
  H5is_library_threadsafe(&safe);
  if (!safe) GTEST_SKIP() << "this HDF5 library is not thread-safe";
  const SavedProblem problem = small_problem();
  write_problem(path("a.h5"), problem);
  const auto work = [&](const std::string& own) {
    for (int i = 0; i < 5; ++i) {
      write_problem(path(own), read_problem(path("a.h5")).saved);
      EXPECT_EQ(content(path(own)), content(path("a.h5")));
      EXPECT_NE(refused(path("nothing")), "");
    }
  };
  std::thread first(work, "b.h5"), second(work, "c.h5");
  first.join();
  second.join();
}

/// Every attribute and dataset of a file, by its path.
std::set<std::string> entries(const std::string& file) {
  std::set<std::string> found;
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t root, const char* name, const H5O_info_t* info,
                        void* data) -> herr_t {
    auto& all = *static_cast<std::set<std::string>*>(data);
    const std::string here = std::string(name) == "." ? "" : "/" + std::string(name);
    if (info->type == H5O_TYPE_DATASET) all.insert(here);
    const hid_t object = H5Oopen(root, name, H5P_DEFAULT);
    for (hsize_t i = 0; i < info->num_attrs; ++i) {
      const hid_t a =
          H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT);
      char attribute[256];
      H5Aget_name(a, sizeof attribute, attribute);
      all.insert(here + "/" + attribute);
      H5Aclose(a);
    }
    H5Oclose(object);
    return 0;
  };
  H5Ovisit2(f, H5_INDEX_NAME, H5_ITER_INC, visit, &found, H5O_INFO_ALL);
  H5Fclose(f);
  return found;
}

/// The entries that docs/reference/problem_files.md describes: under a heading "### `/group`", rows
/// "| `name`".
std::set<std::string> documented() {
  std::set<std::string> found;
  std::ifstream page(std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/problem_files.md");
  std::string line, group;
  bool inside = false;
  while (std::getline(page, line)) {
    if (line.rfind("#", 0) == 0) {
      inside = line.rfind("### `/", 0) == 0;
      if (inside) group = line.substr(5, line.find('`', 5) - 5);
      if (group == "/") group = "";
    }
    if (!inside || line.rfind("| `", 0) != 0) continue;
    // One row may name several, each in backquotes, in its first column.
    std::istringstream names(line.substr(1, line.find('|', 1) - 1));
    for (std::string name; names >> name;) {
      name.erase(
          std::remove_if(name.begin(), name.end(), [](char c) { return c == '`' || c == ','; }),
          name.end());
      found.insert(group + "/" + name);
    }
  }
  return found;
}

TEST_F(ProblemFileTest, TheDocumentationDescribesEveryEntryAndNoOther) {
  NOT_UNDER_SANITIZERS("pages do not depend on the build");
  std::set<std::string> written;
  for (NamedSpecification& named : specifications_of_every_kind()) {
    SavedProblem problem = saved(named);
    problem.warm_start.emplace();
    write_problem(path("a.h5"), problem);
    written.merge(entries(path("a.h5")));
  }
  TermEntry entry{"mine", "a term that is not built in"};
  entry.options = {{"option", 1.0, 0.0, 2.0, "m", "of its own"}};
  entry.make = [](const TermOptions&, const TermContext&) { return nullptr; };
  TermRegistry terms;
  terms.add(entry);
  SavedProblem added = small_problem();
  added.specification.added_terms = {terms.use("mine")};
  added.specification.visibility.odometry.scale = 0.01;
  write_problem(path("a.h5"), added);
  written.merge(entries(path("a.h5")));
  EXPECT_EQ(written.erase("/terms/added/terms/1/options/option"), 1U) << "named by the term";
  EXPECT_GT(written.size(), 100u);
  EXPECT_EQ(written, documented());
}

}  // namespace
}  // namespace prospect::test::problem_file_test

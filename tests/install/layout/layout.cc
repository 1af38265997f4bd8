// SPDX-License-Identifier: Apache-2.0
// The same text from every build of this that links the same libraries: sizes and alignments of
// types that cross the border, and what the libraries read in objects that this program has made.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/pose_error.h"
#include "engine/problem/problem.h"
#include "engine/safety/plan.h"
#include "engine/terms/problem_specification.h"
#include "models/camera.h"
#include "models/robot_description.h"

namespace {

template <typename T>
void tell(const char* name) {
  std::printf("%s %zu %zu\n", name, sizeof(T), alignof(T));
}

}  // namespace

int main() {
  using namespace prospect;
  tell<Belief>("Belief");
  tell<Landmark>("Landmark");
  tell<LandmarkMap>("LandmarkMap");
  tell<Plan>("Plan");
  tell<Problem>("Problem");
  tell<ProblemSpecification>("ProblemSpecification");
  tell<StereoCamera>("StereoCamera");
  tell<CameraMount>("CameraMount");
  tell<RobotDescription>("RobotDescription");
  std::vector<std::unique_ptr<Belief>> beliefs;
  for (int k = 0; k < 5; ++k) {
    beliefs.push_back(std::make_unique<Belief>());
    Belief& belief = *beliefs.back();
    belief.localization = Localization::kLost;
    belief.covariance.diagonal() << 0.1 * k, 0.2 * k, 0.0, 0.01;
    if (k == 4) belief.covariance(0, 1) = 5.0;  // not symmetric
    const std::string error = unbounded_pose_error(belief, 0.7);
    std::printf("%d: %.6f '%s'\n", k, position_sigma(belief.covariance), error.c_str());
  }
  return 0;
}

// A term of one's own in a problem of one's own: drive ahead, and keep away from a person on the
// way. Solved by whichever back end is asked for: user_term [SOLVER].
#include <cstdio>
#include <memory>

#include "engine/terms/control_effort.h"
#include "engine/terms/input_rate.h"
#include "keep_distance.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

int main(int argc, char** argv) {
  const auto model = std::make_shared<prospect::Unicycle>();
  const Eigen::Vector2d ahead(model->max_speed(), 0.0);  // (v, omega)
  const Eigen::Vector2d person(1.2, 0.1);

  prospect::ProblemDefinition definition;
  definition.model = model;
  definition.x0 = Eigen::Vector3d::Zero();  // (x, y, heading)
  definition.u_previous = Eigen::Vector2d::Zero();
  definition.terms = {
      {std::make_shared<prospect::ControlEffort>(ahead, model->limits()), 0.3},
      {std::make_shared<prospect::InputRate>(model->limits()), 0.03},
      {std::make_shared<KeepDistance>(person, 0.5), 1.0},
  };
  const prospect::Problem problem(definition);

  const auto solver = prospect::make_solver(argc > 1 ? argv[1] : "nlopt");
  prospect::WarmStart start;  // straight ahead
  start.x = problem.knots_from_inputs(ahead.transpose().replicate(definition.N, 1));
  const prospect::Result result = solver->solve(problem, start, {}, {});

  const auto nearest = [&](const Eigen::VectorXd& z) {
    const prospect::TrajectoryBatch t = problem.rollout(z);
    double distance = 1e9;
    for (int k = 1; k <= definition.N; ++k) {
      distance = std::min(distance, (t.pose(k, 0).position.head<2>() - person).norm());
    }
    return distance;
  };
  for (const prospect::TermValue& term : result.explanation.terms) {
    std::printf("%-16s %.4f\n", term.name.c_str(), term.weighted);
  }
  std::printf("%s: %s; passes the person at %.2f m instead of %.2f m\n", solver->name().c_str(),
              to_string(result.stop).data(), nearest(result.x), nearest(start.x));
  return nearest(result.x) > nearest(start.x) + 0.1 ? 0 : 1;
}

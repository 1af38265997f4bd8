// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "models/motion_model.h"

namespace prospect {

/// The finite-difference twin of a model: everything is the model's own except the Jacobians, which
/// are fourth-order central differences of step(), per entry i of x or u with step h:
///   df/dx_i = [8 (f(x + h e_i) - f(x - h e_i)) - (f(x + 2h e_i) - f(x - 2h e_i))] / (12 h).
/// Error about h^4 |f^(5)|/30 from truncation plus 1.5 eps |f|/h from rounding: with the default h
/// near 1e-12 for positions of some metres. The oracle of tests; a stand-in while a new model has
/// no closed form yet. Thread-safe like the model; allocates.
class NumericDifference final : public MotionModel {
 public:
  explicit NumericDifference(std::shared_ptr<const MotionModel> model, double h = 1e-3)
      : model_(std::move(model)), h_(h) {}

  std::string_view name() const override { return model_->name(); }
  int nx() const override { return model_->nx(); }
  int nu() const override { return model_->nu(); }
  void step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& u,
            double dt, Eigen::Ref<Eigen::VectorXd> next) const override {
    model_->step(x, u, dt, next);
  }
  void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                 Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const override {
    Eigen::VectorXd next(nx());
    const auto f = [&](const Eigen::VectorXd& xs, const Eigen::VectorXd& us) {
      model_->step(xs, us, dt, next);
      return next;
    };
    const auto difference = [&](int i, bool in_u) {
      const auto moved = [&](double by) {
        Eigen::VectorXd xs = x, us = u;
        (in_u ? us : xs)[i] += by;
        return f(xs, us);
      };
      return Eigen::VectorXd(
          (8.0 * (moved(h_) - moved(-h_)) - (moved(2.0 * h_) - moved(-2.0 * h_))) / (12.0 * h_));
    };
    for (int i = 0; i < nx(); ++i) A.col(i) = difference(i, false);
    for (int j = 0; j < nu(); ++j) B.col(j) = difference(j, true);
  }
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>& u,
                  double dt, Eigen::Ref<BatchArray> next) const override {
    model_->step_batch(x, u, dt, next);
  }
  const InputLimits& limits() const override { return model_->limits(); }
  PoseLayout pose_layout() const override { return model_->pose_layout(); }
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
              const Eigen::Ref<const Eigen::VectorXd>& u) const override {
    return model_->twist(x, u);
  }
  Eigen::VectorXd state(const Pose& pose, const Twist& twist) const override {
    return model_->state(pose, twist);
  }
  Eigen::VectorXd input(const Twist& twist) const override { return model_->input(twist); }
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& previous,
                                double dt) const override {
    return model_->braking_input(x, previous, dt);
  }
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                       Eigen::VectorXd* d_u) const override {
    return model_->squared_speed(x, u, d_x, d_u);
  }
  double max_speed() const override { return model_->max_speed(); }
  double max_yaw_rate() const override { return model_->max_yaw_rate(); }
  double max_deceleration() const override { return model_->max_deceleration(); }
  int num_state_constraints() const override { return model_->num_state_constraints(); }
  void state_constraints(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> values, Eigen::MatrixXd* d_x) const override {
    model_->state_constraints(x, values, d_x);
  }

 private:
  std::shared_ptr<const MotionModel> model_;
  double h_;
};

}  // namespace prospect

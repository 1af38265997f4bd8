// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/clearance_constraint.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {

void write_pose_column(const PoseLayout& layout, const Eigen::Vector4d& g,
                       Eigen::MatrixXd::ColXpr column) {
  column.setZero();
  column[layout.px] = g[0];
  column[layout.py] = g[1];
  if (layout.pz >= 0) column[layout.pz] = g[2];
  column[layout.yaw] = g[3];
}

}  // namespace

ClearanceConstraint::ClearanceConstraint(std::shared_ptr<const BodyClearance> clearance,
                                         Options options)
    : clearance_(std::move(clearance)), options_(std::move(options)) {
  const std::string who = options_.name + " constraint: ";
  if (clearance_ == nullptr) throw std::invalid_argument(who + "no clearance");
  if (!std::isfinite(options_.d_safe) || !std::isfinite(options_.floor) ||
      options_.floor > options_.d_safe) {
    throw std::invalid_argument(who + "floor = " + std::to_string(options_.floor) +
                                " m, d_safe = " + std::to_string(options_.d_safe) +
                                " m; expected floor <= d_safe");
  }
  if (!(options_.slack >= 0.0) || !std::isfinite(options_.slack)) {
    throw std::invalid_argument(who + "slack = " + std::to_string(options_.slack) +
                                " m; expected >= 0");
  }
  if (!(clearance_->saturation() > options_.d_safe)) {
    throw std::invalid_argument(who + "the clearance saturates at " +
                                std::to_string(clearance_->saturation()) +
                                " m; expected above d_safe = " + std::to_string(options_.d_safe) +
                                " m (raise the field's cutoff)");
  }
}

TermTraits ClearanceConstraint::traits() const {
  return {TermKind::kConstraint, Smoothness::kC1, true, "m", "none", false, options_.quantity};
}

std::vector<JacobianBlock> ClearanceConstraint::jacobian_pattern(const Horizon& horizon) const {
  std::vector<JacobianBlock> blocks;
  blocks.reserve(static_cast<std::size_t>(3 * horizon.N));
  for (int k = 1; k <= horizon.N; ++k) blocks.push_back({k - 1, k, false});
  for (int k = 0; k < horizon.N; ++k) {
    blocks.push_back({horizon.N + k, k, false});
    blocks.push_back({horizon.N + k, k + 1, false});
  }
  return blocks;
}

double ClearanceConstraint::required(double d_0, double t) const {
  const double floor = options_.floor;
  if (d_0 >= options_.d_safe) return options_.d_safe;
  if (d_0 >= floor) return std::max(floor, d_0 - options_.slack);
  const double start = d_0 - options_.slack;
  return std::min(options_.d_safe, start + (floor - start) * t * t);
}

void ClearanceConstraint::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                                   TermScratch*, TermOutput& out) const {
  const int N = t.horizon.N;
  Eigen::Vector4d g;
  Eigen::Vector4d* const g_out = request.gradient ? &g : nullptr;
  for (int b = 0; b < t.batch(); ++b) {
    Pose here = t.pose(0, b);
    const double d_0 = clearance_->clearance(here);
    for (int k = 0; k < N; ++k) {
      const Pose next = t.pose(k + 1, b);
      const Pose middle{0.5 * (here.position + next.position), 0.5 * (here.yaw + next.yaw)};
      out.value(N + k, b) = clearance_->clearance(middle, g_out) - required(d_0, (k + 0.5) / N);
      if (request.gradient) {
        g *= 0.5;
        write_pose_column(t.layout, g, out.jacobian.col(N + 2 * k));
        write_pose_column(t.layout, g, out.jacobian.col(N + 2 * k + 1));
      }
      out.value(k, b) = clearance_->clearance(next, g_out) - required(d_0, (k + 1.0) / N);
      if (request.gradient) write_pose_column(t.layout, g, out.jacobian.col(k));
      here = next;
    }
  }
}

}  // namespace prospect

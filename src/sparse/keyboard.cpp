#include "erard/sparse/keyboard.hpp"

#include <numbers>
#include <stdexcept>

namespace erard {

Model put_on_frame(const Model& action, const KeyboardFrame& frame, double share) {
  if (action.body_count >= kMaxBodies) throw std::invalid_argument("put_on_frame: no room for one more body");
  Model model = action;
  Body& carrier = model.bodies[0];
  carrier = {};
  carrier.name = "frame";
  carrier.joint = JointKind::prismatic;
  carrier.direction = std::numbers::pi / 2;
  carrier.mass = share * frame.mass;
  carrier.viscous = share * frame.viscous;
  carrier.spring.stiffness = share * frame.stiffness;
  double carried = carrier.mass;
  for (int i = 0; i < action.body_count; ++i) carried += action.bodies[i].mass;
  carrier.spring.rest = -action.gravity.y() * carried / carrier.spring.stiffness;  // carries the weight at 0
  for (int i = 0; i < action.body_count; ++i) {
    model.bodies[i + 1] = action.bodies[i];
    ++model.bodies[i + 1].parent;  // the ground, -1, becomes the frame
  }
  ++model.body_count;
  for (int c = 0; c < model.contact_count; ++c) {
    ++model.contacts[c].body_a;
    ++model.contacts[c].body_b;
  }
  if (model.finger.body != kGround) ++model.finger.body;
  return model;
}

ActionStep last_linearisation(const Mechanism& mechanism, const Workspace& work) {
  const int n = mechanism.coordinate_count;
  ActionStep step;
  step.A = work.iteration_matrix;
  step.A.triangularView<Eigen::StrictlyUpper>() = step.A.transpose();
  step.R = Eigen::Map<const Eigen::VectorXd>(work.smooth_residual.data(), n);
  step.is_fixed.assign(work.is_fixed.begin(), work.is_fixed.begin() + n);
  std::vector<int> rows;  // the laws that are no function of the velocity, those of open contacts left out
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    const bool is_touching = row.kind != RowKind::tangential || mechanism.rows.row[row.normal].kind != RowKind::felt ||
                             work.felt[row.index].impulse > 0;
    const bool is_free = row.kind != RowKind::hinge || !work.is_fixed[row.index];
    if (row.kind != RowKind::felt && is_touching && is_free) rows.push_back(k);
  }
  step.H.setZero(n, static_cast<Eigen::Index>(rows.size()));
  for (std::size_t j = 0; j < rows.size(); ++j)
    direction_of(mechanism, work, mechanism.rows.row[rows[j]]).apply(1.0, step.H.col(static_cast<Eigen::Index>(j)));
  return step;
}

KeyboardStep assemble_keyboard(std::span<const ActionStep> actions, bool is_clamped) {
  using Triplets = std::vector<Eigen::Triplet<double>>;
  KeyboardStep whole;
  int n = 1, m = 0;
  for (const ActionStep& action : actions) {
    whole.first.push_back(n);
    whole.first_row.push_back(m);
    n += static_cast<int>(action.A.rows()) - 1;
    m += static_cast<int>(action.H.cols());
  }
  whole.first_row.push_back(m);
  whole.R.setZero(n);
  Triplets in_A, in_H;
  for (std::size_t k = 0; k < actions.size(); ++k) {
    const ActionStep& action = actions[k];
    const int size = static_cast<int>(action.A.rows());
    const auto place = [&](int i) { return i == 0 ? 0 : whole.coordinate(static_cast<int>(k), i); };
    const auto is_out = [&](int i) { return action.is_fixed[i] || (i == 0 && is_clamped); };
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j)
        if (action.A(i, j) != 0 || i == j)
          in_A.emplace_back(place(i), place(j), is_out(i) || is_out(j) ? (i == j ? 1.0 : 0.0) : action.A(i, j));
      if (!is_out(i)) whole.R[place(i)] += action.R[i];
      for (int j = 0; j < action.H.cols(); ++j)
        if (action.H(i, j) != 0) in_H.emplace_back(place(i), whole.first_row[k] + j, is_out(i) ? 0.0 : action.H(i, j));
    }
  }
  whole.A.resize(n, n);
  whole.A.setFromTriplets(in_A.begin(), in_A.end());  // adds up what falls on one place
  whole.H.resize(n, m);
  whole.H.setFromTriplets(in_H.begin(), in_H.end());
  return whole;
}

}  // namespace erard

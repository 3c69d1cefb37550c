// Mass matrix, gyroscopic terms and weight: mechanics/dynamics.hpp in lanes, operation by operation.
#pragma once

#include "geometry.hpp"

namespace erard::lanes {

template <typename T>
void assemble_mass_matrix(const Batch& batch, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  T mass[kMaxBodies], inertia[kMaxBodies];
  Vector<T> moment[kMaxBodies];
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyNumbers<T>& body = action.body[i];
    mass[i] = body.mass;
    moment[i] = body.mass * turned(work, i, body.centre);
    inertia[i] = body.inertia;
    for (int j = 0; j < i; ++j) work.mass_matrix[i][j] = T(0.0);
  }
  for (int i = plan.body_count - 1; i >= 0; --i) {
    const bool is_prismatic = plan.body[i].is_prismatic;
    work.mass_matrix[i][i] = is_prismatic ? mass[i] : inertia[i];
    const int parent = plan.body[i].parent;
    if (parent < 0) continue;
    // what the coordinates above feel of a unit rate of this one
    const Vector<T> l = is_prismatic ? mass[i] * work.slide[i] : perp(moment[i]);
    T k = is_prismatic ? cross(moment[i], work.slide[i]) : inertia[i];
    Vector<T> pivot = work.origin[i];
    for (int j = parent; j >= 0; j = plan.body[j].parent) {
      k = k + cross(pivot - work.origin[j], l);
      pivot = work.origin[j];
      work.mass_matrix[i][j] = plan.body[j].is_prismatic ? dot(work.slide[j], l) : k;
    }
    const Vector<T> r = work.origin[i] - work.origin[parent];
    mass[parent] += mass[i];
    moment[parent] = moment[parent] + (moment[i] + mass[i] * r);
    inertia[parent] += inertia[i] + T(2.0) * dot(r, moment[i]) + mass[i] * dot(r, r);
  }
}

template <typename T>
void assemble_bias(const Batch& batch, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const T* v = work.placed_rate;
  T rate[kMaxBodies], moment[kMaxBodies];
  Vector<T> acceleration[kMaxBodies], force[kMaxBodies];
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyPlan& body = plan.body[i];
    if (body.parent < 0) {
      rate[i] = T(0.0);
      acceleration[i] = {-action.gravity.x, -action.gravity.y};
    } else {
      const T carried = rate[body.parent];
      rate[i] = carried;
      acceleration[i] = acceleration[body.parent] - carried * carried * (work.origin[i] - work.origin[body.parent]);
      if (body.is_prismatic) acceleration[i] = acceleration[i] + T(2.0) * carried * v[i] * perp(work.slide[i]);
    }
    if (!body.is_prismatic) rate[i] += v[i];
    const T m = action.body[i].mass;
    const Vector<T> s = m * turned(work, i, action.body[i].centre);
    force[i] = m * acceleration[i] - rate[i] * rate[i] * s;
    moment[i] = cross(s, acceleration[i]);
  }
  for (int i = plan.body_count - 1; i >= 0; --i) {
    const int parent = plan.body[i].parent;
    work.bias[i] = plan.body[i].is_prismatic ? dot(work.slide[i], force[i]) : moment[i];
    if (parent < 0) continue;
    force[parent] = force[parent] + force[i];
    moment[parent] += moment[i] + cross(work.origin[i] - work.origin[parent], force[i]);
  }
}

}  // namespace erard::lanes

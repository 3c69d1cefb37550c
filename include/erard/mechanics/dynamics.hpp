// Mass matrix, gyroscopic terms and weight of the whole tree, felts included.
#pragma once

#include "erard/mechanics/contact_frames.hpp"

namespace erard {

/// Mass, first moment and moment of inertia of a body with all that hangs on it, about its own joint, in ground axes.
struct Inertia {
  double mass = 0;                   // [kg]
  Vector2 moment = Vector2::Zero();  // mass times position of the centre of gravity [kg m]
  double inertia = 0;                // [kg m^2]
};

/// Mass matrix M(x) of the kinetic energy T = v.M v / 2                            thesis (4.17), Appendix B
/// Composite bodies from the leaves inwards; entries between coordinates of different branches are zero and are left
/// as they are after the initial setZero. Felts are points on slides along their axes; that an axis
/// which follows a contact normal also turns in its carrier is left out (d' times 10 mg times that rate: some nN s).
/// Departs from the thesis: (4.17) prints I_J, I_L where the parallel-axis terms need masses.
/// @param M (n x n) set whole
inline void assemble_mass_matrix(const Mechanism& mechanism, const Frames& frames, const ContactFrames& contacts,
                                 CoordinateMatrix& M) noexcept {
  const Model& model = mechanism.model;
  const int n = mechanism.coordinate_count;
  M.setZero(n, n);
  std::array<Inertia, kMaxBodies> composite;
  for (int i = 0; i < model.body_count; ++i) {
    const Body& body = model.bodies[i];
    composite[i] = {body.mass, body.mass * frames.body[i].turned(body.centre), body.inertia};
  }
  // unit rate of coordinate i gives its subtree the linear momentum l and the moment of momentum k about `pivot`:
  // what each coordinate above feels of it
  const auto spread = [&](int i, int above, Vector2 l, double k, Vector2 pivot) noexcept {
    for (int j = above; j != kGround; j = model.bodies[j].parent) {
      const Frame& frame = frames.body[j];
      k += cross(pivot - frame.origin, l);
      pivot = frame.origin;
      M(i, j) = M(j, i) = model.bodies[j].joint == JointKind::hinge ? k : frame.slide.dot(l);
    }
  };
  for (int c = 0; c < model.contact_count; ++c) {
    const int i = mechanism.felt_coordinate[c];
    if (i < 0) continue;
    const double m = model.contacts[c].felt.mass;
    M(i, i) = m;
    const int holder = mechanism.parent[i];
    spread(i, holder, m * contacts[c].felt_slide, 0, contacts[c].felt_point);
    if (holder == kGround) continue;
    const Vector2 r = contacts[c].felt_point - frames.body[holder].origin;
    composite[holder].mass += m;
    composite[holder].moment += m * r;
    composite[holder].inertia += m * r.squaredNorm();
  }
  for (int i = model.body_count - 1; i >= 0; --i) {
    const Body& body = model.bodies[i];
    const Frame& frame = frames.body[i];
    const Inertia& own = composite[i];
    if (body.joint == JointKind::hinge) {
      M(i, i) = own.inertia;
      spread(i, body.parent, perp(own.moment), own.inertia, frame.origin);
    } else {
      M(i, i) = own.mass;
      spread(i, body.parent, own.mass * frame.slide, cross(own.moment, frame.slide), frame.origin);
    }
    if (body.parent == kGround) continue;
    const Vector2 r = frame.origin - frames.body[body.parent].origin;
    Inertia& holder = composite[body.parent];
    holder.mass += own.mass;
    holder.moment += own.moment + own.mass * r;
    holder.inertia += own.inertia + 2 * r.dot(own.moment) + own.mass * r.squaredNorm();
  }
}

/// Loads that motion and weight need: N(x,v) v - weight                            thesis (4.14), (4.15), (4.19)
/// Newton-Euler with all second derivatives of the coordinates zero.
/// @param v    rates (n), indexed by []
/// @param bias (n, of that size already) set whole [N m] on hinges, [N] on slides and felts; it stands on the left of M dv/dt + bias = loads
template <typename Rates, typename Loads>
void assemble_bias(const Mechanism& mechanism, const Frames& frames, const ContactFrames& contacts, const Rates& v,
                   const Vector2& gravity, Loads& bias) noexcept {
  const Model& model = mechanism.model;
  for (int i = 0; i < mechanism.coordinate_count; ++i) bias[i] = 0;
  std::array<double, kMaxBodies> rate;           // absolute angular rate [rad/s]
  std::array<Vector2, kMaxBodies> acceleration;  // of the joint, weight included as -g [m/s^2]
  std::array<Vector2, kMaxBodies> force;         // that the body and all on it need [N]
  std::array<double, kMaxBodies> moment;         // the same, about its joint [N m]
  for (int i = 0; i < model.body_count; ++i) {
    const Body& body = model.bodies[i];
    const Frame& frame = frames.body[i];
    const bool on_ground = body.parent == kGround;
    const double carried = on_ground ? 0.0 : rate[body.parent];
    const Vector2 r = frame.origin - frames.of(body.parent).origin;
    rate[i] = carried;
    acceleration[i] = (on_ground ? Vector2(-gravity) : acceleration[body.parent]) - carried * carried * r;
    if (body.joint == JointKind::hinge)
      rate[i] += v[i];
    else
      acceleration[i] += 2 * carried * v[i] * perp(frame.slide);
    const Vector2 s = body.mass * frame.turned(body.centre);
    force[i] = body.mass * acceleration[i] - rate[i] * rate[i] * s;
    moment[i] = cross(s, acceleration[i]);
  }
  for (int c = 0; c < model.contact_count; ++c) {
    const int i = mechanism.felt_coordinate[c];
    if (i < 0) continue;
    const ContactFrame& contact = contacts[c];
    const double m = model.contacts[c].felt.mass;
    const int holder = mechanism.parent[i];
    if (holder == kGround) {
      bias[i] = -m * contact.felt_slide.dot(gravity);
      continue;
    }
    const Vector2 r = contact.felt_point - frames.body[holder].origin;
    const double w = rate[holder];
    const Vector2 f = m * (acceleration[holder] - w * w * r + 2 * w * v[i] * perp(contact.felt_slide));
    bias[i] = contact.felt_slide.dot(f);
    force[holder] += f;
    moment[holder] += cross(r, f);
  }
  for (int i = model.body_count - 1; i >= 0; --i) {
    const Body& body = model.bodies[i];
    bias[i] = body.joint == JointKind::hinge ? moment[i] : frames.body[i].slide.dot(force[i]);
    if (body.parent == kGround) continue;
    force[body.parent] += force[i];
    moment[body.parent] += moment[i] + cross(frames.body[i].origin - frames.body[body.parent].origin, force[i]);
  }
}

/// Gyroscopic matrix N(x,v) of (4.19): N v are the centrifugal and Coriolis terms, N_ij = sum_k Gamma_ijk v_k with the
/// Christoffel symbols Gamma. By polarisation of the quadratic form, exact. Not used by the step; for studies and tests.
/// @return (n x n)
inline CoordinateMatrix gyroscopic_matrix(const Mechanism& mechanism, const Frames& frames,
                                          const ContactFrames& contacts, const CoordinateVector& v) noexcept {
  const int n = mechanism.coordinate_count;
  CoordinateMatrix N(n, n);
  CoordinateVector plus(n), minus(n);
  for (int j = 0; j < n; ++j) {
    CoordinateVector moved = v;
    moved[j] += 1;
    assemble_bias(mechanism, frames, contacts, moved, Vector2::Zero(), plus);
    moved[j] -= 2;
    assemble_bias(mechanism, frames, contacts, moved, Vector2::Zero(), minus);
    N.col(j) = (plus - minus) / 4;
  }
  return N;
}

}  // namespace erard

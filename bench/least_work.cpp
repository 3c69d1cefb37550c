#include "bench/least_work.hpp"

namespace erard::bench {
namespace {

constexpr double kPower = 50, kSineAndCosine = 40;
constexpr double kTurn = 6, kAdd = 2, kDot = 3, kCross = 3;  // of plane vectors; a rotation of one
constexpr double kPlace = kTurn + kAdd;                      // a point of a body into the ground frame

bool is_on_ground(const Model& model, int body) { return model.bodies[body].parent == kGround; }

int depth_of(const Mechanism& mechanism, int coordinate) {
  int depth = 0;
  for (int j = mechanism.parent[coordinate]; j != kGround; j = mechanism.parent[j]) ++depth;
  return depth;
}

double frames(const Model& model) {
  double sum = 0;
  for (int i = 0; i < model.body_count; ++i) sum += kSineAndCosine + (is_on_ground(model, i) ? 0 : kPlace + 1);
  return sum;
}

double shape(const Shape& shape, int body) {
  const bool is_segment = shape.kind == ShapeKind::segment;
  const double placed = body == kGround ? 0 : kPlace + (is_segment ? kTurn : 0);
  const double nearest = is_segment ? kAdd + kDot + 2 + 4 : 0;  // foot of the other point, clamped
  return placed + nearest;
}

/// Line between the cores, its length (root included), direction, the gap, the point on one surface.
double gap(const Contact& contact) {
  return shape(contact.shape_a, contact.body_a) + shape(contact.shape_b, contact.body_b) + kAdd + (kDot + 1) + 3 + 2 +
         4;
}

/// Composite bodies, their momenta spread to the coordinates above; Newton-Euler with what they have in common left out.
double dynamics(const Mechanism& mechanism) {
  const Model& model = mechanism.model;
  double sum = 0;
  for (int i = 0; i < model.body_count; ++i) {
    sum += kTurn + 2;                                     // first moment in ground axes
    sum += (kAdd + kCross + 1) * depth_of(mechanism, i);  // column of M
    sum += 2 + 1 + 2 + 2 + kCross;                        // force m a - w^2 s, moment s x a
    if (is_on_ground(model, i)) continue;
    sum += kAdd;                             // from the joint of the parent
    sum += 4 + (kDot + 1) + (kDot + 1) + 2;  // moment and moment of inertia of the composite
    sum += 1 + 1 + 2 + 2;                    // rate, acceleration a - w^2 r
    sum += kAdd + kCross + 2;                // force and moment handed on
  }
  return sum;
}

/// R <- M dv + h bias, springs and losses, finger; gaps at the end of the step; closed felts into R and A.
double linearisation(const Mechanism& mechanism, const State& after) {
  const Model& model = mechanism.model;
  double sum = 12;  // finger
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    sum += 1 + 2 + 2 + 4 * depth_of(mechanism, i);
    if (model.bodies[i].viscous > 0) sum += 2 + 1;
    if (model.bodies[i].spring.stiffness > 0) sum += 3;
  }
  for (int c = 0; c < model.contact_count; ++c) {
    const int row = mechanism.normal_row[c];
    if (row < 0) continue;
    const double path = mechanism.path[c].count;
    sum += 2 * path;
    if (after.impulse[row] > 0) sum += 2 * path + path + path * (path + 1);
  }
  return sum;
}

double factorisation(const AncestorTable& above) {
  double sum = 0;
  for (int k = 0; k < above.size; ++k) {
    const double count = above.count[k];
    sum += 1 + count + count * (count + 1);  // 1/D, column of L, update of what is above
    sum += 1 + 1 + 2 * 2 * count;            // load, D^-1, up and down
  }
  return sum;
}

/// Laws that are closed at the end: one power each, that of the start is known. Left felts open by one power.
double felt_laws(const Mechanism& mechanism, const State& after) {
  double sum = 0;
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    const int row = mechanism.normal_row[c];
    if (row < 0) continue;
    if (after.impulse[row] > 0)
      sum += kPower + 19;  // k d^r, quotient of the energies, damping, slopes of both, by h
    else if (after.compression[c] > 0)
      sum += kPower + 3;
  }
  return sum;
}

/// Load of what slides, and whether it still goes that way; what sticks needs a row of A.
double friction(const Mechanism& mechanism, const State& after) {
  double sum = 0;
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind == RowKind::tangential && after.impulse[row.normal] > 0)
      sum += 1 + 2 * 2 * mechanism.path[row.index].count + 2;
    if (row.kind != RowKind::hinge) continue;
    const bool sticks = after.v[row.index] == 0;
    sum += sticks ? 2 * mechanism.coordinate_count + 1 : 3;
  }
  return sum;
}

}  // namespace

std::string_view name_of(Phase phase) {
  constexpr std::string_view names[kPhases] = {"iterate",  "frames",    "gaps",          "levers",
                                               "dynamics", "felt laws", "linearisation", "factorisation",
                                               "friction", "rows",      "sweeps",        "finish"};
  return names[static_cast<int>(phase)];
}

Work least_work(const Mechanism& mechanism, const State& after) {
  Work work{};
  const auto of = [&work](Phase phase) -> double& { return work[static_cast<std::size_t>(phase)]; };
  const int n = mechanism.coordinate_count;
  // per coordinate: guess 2, rate and position at the middle 5, shift to the end 2, new velocity 1, its movement 6
  of(Phase::iterate) = 16 * n;
  of(Phase::finish) = 3 * n + 6;  // position, acceleration, whether they are finite; force of the finger
  of(Phase::frames) = frames(mechanism.model);
  of(Phase::dynamics) = dynamics(mechanism);
  of(Phase::felt_laws) = felt_laws(mechanism, after);
  of(Phase::linearisation) = linearisation(mechanism, after);
  of(Phase::factorisation) = factorisation(mechanism.elimination);
  of(Phase::friction) = friction(mechanism, after);
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    const int row = mechanism.normal_row[c];
    if (row < 0) continue;
    const double path = mechanism.path[c].count;
    const bool is_closed = after.impulse[row] > 0;
    const bool has_tangent = is_closed && mechanism.model.contacts[c].friction > 0;
    of(Phase::gaps) += gap(mechanism.model.contacts[c]);
    of(Phase::levers) += path * (kAdd + kDot + (has_tangent ? kDot : 0));
    if (!is_closed) continue;
    of(Phase::iterate) += 2 * path + 2;  // impulse at the end velocity
    of(Phase::finish) += 2 * path + 2;   // its compression
  }
  return work;
}

}  // namespace erard::bench

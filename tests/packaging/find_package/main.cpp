// A host of erard: lets a pendulum go and looks whether it falls.
#include <erard/erard.hpp>

#include <cmath>
#include <cstdio>

int coordinates_of(const erard::Model& model);  // second_unit.cpp

int main() {
  erard::Model model;
  model.name = "pendulum";
  model.body_count = 1;
  erard::Body& rod = model.bodies[0];
  rod.name = "rod";
  rod.mass = 0.01;            // [kg]
  rod.centre = {0.1, 0.0};    // [m]
  rod.inertia = 0.01 * 0.01;  // [kg m^2] point mass on a massless rod

  const erard::Mechanism mechanism = erard::build_mechanism(model);
  const erard::Scheme scheme;
  erard::State state = erard::rest_state(mechanism, scheme.time_step);
  erard::Workspace work;
  const erard::StepReport report = erard::step(mechanism, scheme, erard::Drive{}, state, work);

  // released level: -g/l; within the first step the lever arm of the weight changes by less than 1e-6 of itself
  const double expected = -9.81 / 0.1 * scheme.time_step;
  const bool is_good = report.status == erard::StepStatus::converged && coordinates_of(model) == 1 &&
                       std::abs(state.v[0] / expected - 1) < 1e-6;
  std::printf("erard %s: %s\n", erard::kVersion.data(), is_good ? "good" : "bad");
  return is_good ? 0 : 1;
}

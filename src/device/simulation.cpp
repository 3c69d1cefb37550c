#include "erard/device/keystroke_input.hpp"
#include "erard/device/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "erard/mechanics/rest.hpp"

namespace erard {
namespace {

double start_force(const Mechanism& mechanism, const TickSettings& tick, const State& state, const DriveSample& input) {
  if (tick.drive == DriveKind::piston) return piston_force(mechanism.model, state, input);
  return tick.drive == DriveKind::force ? input.value : 0.0;
}

void count_step(const StepReport& report, double force, double time, RunResult& result) {
  ++result.steps;
  result.not_converged += report.status == StepStatus::not_converged;
  if (force <= result.peak_force) return;
  result.peak_force = force;
  result.peak_force_time = time;
}

}  // namespace

Snapshot take_snapshot(const Mechanism& mechanism, const State& state, const DriveSample& input, double force) {
  const Model& model = mechanism.model;
  Snapshot row;
  row.time = state.time;
  row.input = input;
  row.force = force;
  if (model.finger.body != kGround) row.key_position = key_position(model, state);
  Frames frames;
  place_bodies(model, state.x, frames);
  for (int i = 0; i < model.body_count; ++i) {
    const Body& body = model.bodies[i];
    const bool is_hinge = body.joint == JointKind::hinge;
    double rate = state.v[i];
    for (int j = body.parent; is_hinge && j != kGround; j = model.bodies[j].parent)
      if (model.bodies[j].joint == JointKind::hinge) rate += state.v[j];
    row.angle.push_back(is_hinge ? frames.body[i].angle : state.x[i]);
    row.rate.push_back(rate);
    const int hinge = find_row(mechanism.rows, RowKind::hinge, i);
    row.hinge_moment.push_back(hinge < 0 ? 0.0 : state.impulse[hinge] / state.time_step);
  }
  for (int c = 0; c < model.contact_count; ++c) {
    const Contact& contact = model.contacts[c];
    const int felt = mechanism.felt_coordinate[c];
    const int normal = mechanism.normal_row[c];
    const double force_c = normal < 0 ? 0.0 : state.impulse[normal] / state.time_step;
    const double gap = locate_contact(contact, frames, felt < 0 ? 0.0 : state.x[felt]).gap;
    const double compression = contact.has_felt && force_c > 0 ? compression_of(mechanism, state, c) : -gap;
    row.compression.push_back(contact.is_active ? compression : 0.0);
    row.normal.push_back(force_c);
    const int tangent = find_row(mechanism.rows, RowKind::tangential, c);
    row.tangential.push_back(tangent < 0 ? 0.0 : state.impulse[tangent] / state.time_step);
  }
  return row;
}

RunResult run(const ActionFile& action, const Keystroke& keystroke, const RunSettings& settings) {
  using Clock = std::chrono::steady_clock;
  TickSettings tick_settings = settings.tick;
  if (settings.on_problem) tick_settings.scheme.is_friction_recalled = false;  // there must be a problem to show
  const Mechanism mechanism = build_mechanism(action.model);
  const KeystrokeInput input{&keystroke};
  const auto work = std::make_unique<Workspace>();
  State state = rest_state(mechanism, tick_settings.scheme.time_step);
  state.time = settings.start;
  EventDetector detector(mechanism, action.roles);
  RunResult result;

  const auto show = [&](double force) {
    if (settings.on_row) settings.on_row(take_snapshot(mechanism, state, input.at(state.time), force));
  };
  const auto observe = [&](const State& now, const StepReport& report, double force) noexcept {
    detector.observe(now, force);
    count_step(report, force, now.time, result);
    if (settings.on_problem) settings.on_problem(work->problem, work->impulse, now.time);
  };

  show(start_force(mechanism, tick_settings, state, input.at(state.time)));
  const long periods = std::lround(settings.duration / tick_settings.period);
  while (result.periods < periods && result.is_finite && result.is_complete) {
    const auto before = Clock::now();
    const TickReport report = tick(mechanism, tick_settings, input, state, *work, observe);
    const double spent = std::chrono::duration<double>(Clock::now() - before).count();
    result.computing_time += spent;
    result.tick_time.add(spent);
    result.linearisations += report.linearisations;
    result.sweeps += report.sweeps;
    result.is_finite = report.status != StepStatus::not_finite;
    if (!result.is_finite) break;
    ++result.periods;
    state.time = settings.start + static_cast<double>(result.periods) * tick_settings.period;  // no drift by rounding
    show(report.force);
    if (settings.goes_on && !settings.goes_on(static_cast<double>(result.periods) / static_cast<double>(periods)))
      result.is_complete = result.periods == periods;
  }
  detector.finish();
  for (int i = 0; i < detector.count(); ++i) result.events.push_back(detector[i]);
  std::stable_sort(result.events.begin(), result.events.end(),
                   [](const Event& a, const Event& b) { return a.time < b.time; });
  result.events_lost = detector.seen() - detector.count();
  return result;
}

}  // namespace erard

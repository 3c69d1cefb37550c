#include "study/simple_models.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "erard/device/force_curve.hpp"
#include "study/defaults.hpp"

namespace erard::study::simple {
namespace {

/// Values over time; ForceCurve is what relative_error() takes, whatever the unit.
using Curve = ForceCurve;

Curve window(const Curve& curve, double from, double until) {
  Curve part;
  for (std::size_t i = 0; i < curve.time.size(); ++i) {
    if (curve.time[i] < from || curve.time[i] > until) continue;
    part.time.push_back(curve.time[i]);
    part.force.push_back(curve.force[i]);
  }
  return part;
}

/// @param curve  at instants of the reference
Error distance(const Curve& reference, const Curve& curve, double from, double until) {
  const Curve part = window(curve, from, until);
  if (part.time.size() < 2) return {};
  Error error{relative_error(reference, part, until), 0};
  std::size_t i = 0;
  for (std::size_t k = 0; k < part.time.size(); ++k) {
    while (reference.time[i] < part.time[k]) ++i;
    error.largest = std::max(error.largest, std::abs(part.force[k] - reference.force[i]));
  }
  return error;
}

PhaseErrors by_phase(const Curve& reference, const Curve& curve, const KeyRecord& record, double carried) {
  const double start = record.motion.time.front();
  return {distance(reference, curve, start, carried), distance(reference, curve, carried, record.let_off),
          distance(reference, curve, record.let_off, record.release),
          distance(reference, curve, start, record.release)};
}

Curve position(const KeyMotion& motion, double arm) {
  Curve y{motion.time, motion.angle};
  for (double& value : y.force) value *= arm;
  return y;
}

Keystroke force_of(const KeyRecord& record) { return {KeystrokeQuantity::force, record.motion.time, record.force}; }

KeyStart start_at(const KeyRecord& record, std::size_t i) {
  return {record.motion.time[i], record.motion.angle[i], record.motion.rate[i]};
}

Verdict compare(const SimpleAction& model, const KeyRecord& record, double carried, const KeyStart& start) {
  const std::vector<double>& time = record.motion.time;
  const KeyMotion moved = move(model, force_of(record), time, start);
  const Curve felt = window({time, feel(model, record.motion)}, start.time, time.back());
  return {by_phase(position(record.motion, model.arm), position(moved, model.arm), record, carried),
          by_phase({time, record.force}, felt, record, carried)};
}

/// The record from row `first` on.
KeyRecord tail(KeyRecord record, std::size_t first) {
  for (auto* values : {&record.motion.time, &record.motion.angle, &record.motion.rate, &record.motion.acceleration,
                       &record.force, &record.hammer_rate})
    values->erase(values->begin(), values->begin() + static_cast<std::ptrdiff_t>(first));
  return record;
}

void round_to_grain(std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  const double grain = largest / 200;
  for (double& v : values) v = grain * std::round(v / grain);
}

KeyRecord rounded(KeyRecord record) {
  for (auto* values : {&record.motion.angle, &record.motion.rate, &record.motion.acceleration, &record.force})
    round_to_grain(*values);
  return record;
}

/// What comes out at the end of a path.
Curve outcome(Path path, const SimpleAction& model, const KeyRecord& record, const KeyStart& start) {
  KeyMotion motion = record.motion;
  const std::vector<double>& time = motion.time;
  switch (path) {
    case Path::force_to_motion: return position(move(model, force_of(record), time, start), model.arm);
    case Path::motion_to_force: break;
    case Path::position_to_force:
      motion.rate = differentiate(time, motion.angle);
      motion.acceleration = differentiate(time, motion.rate);
      break;
    case Path::acceleration_to_force:
      motion.rate = integrate(time, motion.acceleration, start.rate);
      motion.angle = integrate(time, motion.rate, start.angle);
      break;
  }
  return {time, feel(model, motion)};
}

}  // namespace

Verdict judge(const SimpleAction& model, const KeyRecord& record, double carried) {
  return compare(model, record, carried, start_at(record, 0));
}

Verdict judge_alone(SimpleAction model, const KeyRecord& record, double carried, double down_force) {
  model.takeover_angle = 0;
  return compare(model, record, carried, start_at(record, row_of_force(record, down_force)));
}

KeyRecord simple_record(SimpleAction model, const KeyRecord& record, double down_force) {
  model.takeover_angle = 0;
  KeyRecord simple = tail(record, row_of_force(record, down_force));
  simple.motion = move(model, force_of(simple), simple.motion.time, start_at(simple, 0));
  simple.motion.acceleration = differentiate(simple.motion.time, simple.motion.rate);
  return simple;
}

InertiaScan scan_inertia(const SimpleAction& model, const KeyRecord& record) {
  InertiaScan scan{0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (int i = 2; i <= 30; ++i) {
    SimpleAction changed = model;
    changed.key.inertia *= 0.05 * i;
    const Verdict verdict = judge(changed, record, record.motion.time.front());
    scan.least_force = std::min(scan.least_force, verdict.force.whole.eta);
    if (verdict.motion.whole.eta >= scan.least_motion) continue;
    scan.least_motion = verdict.motion.whole.eta;
    scan.best_factor = 0.05 * i;
  }
  return scan;
}

Sensitivity sensitivity(Path path, SimpleAction model, const KeyRecord& record, double down_force, double until) {
  model.takeover_angle = 0;
  const KeyRecord seen = tail(record, row_of_force(record, down_force));
  const KeyStart start = start_at(seen, 0);
  const KeyStart moved{start.time, start.angle + 1e-4 / model.arm, start.rate + 1e-2 / model.arm};
  const bool gives_motion = path == Path::force_to_motion;
  const Curve truth = gives_motion ? position(seen.motion, model.arm) : Curve{seen.motion.time, seen.force};
  const Curve clean = outcome(path, model, seen, start);
  return {relative_error(truth, clean, until), relative_error(clean, outcome(path, model, seen, moved), until),
          relative_error(clean, outcome(path, model, rounded(seen), start), until)};
}

SimpleModelsStudy study_simple_models() {
  const ActionFile action = default_action();
  const auto record = [&](const char* name, double release) {
    return record_keystroke(action, default_keystroke(name), name, release);
  };
  SimpleModelsStudy study;
  // releases of these two files, as in docs/accuracy.md
  study.piano.record = record("piano", 0.220);
  study.forte.record = record("forte", 0.142);
  study.parts = measure_parts(action);
  study.model =
      action_model(action, study.parts, blocked_stiffness({study.piano.record, study.forte.record}, study.parts));
  for (Stroke* stroke : {&study.piano, &study.forte})
    stroke->carried = carried_from(stroke->record, study.parts.alpha31);
  return study;
}

}  // namespace erard::study::simple

#include "study/device_fidelity.hpp"

#include <algorithm>
#include <cmath>

#include "erard/device/simulation.hpp"
#include "study/defaults.hpp"

namespace erard::study {

ReferenceStroke reference_stroke(const ActionFile& action, const std::string& keystroke, double end) {
  const Keystroke piston = default_keystroke(keystroke);
  ReferenceStroke stroke;
  stroke.name = keystroke;
  stroke.end = end;
  RunSettings settings;
  settings.start = piston.start();
  settings.duration = piston.end() - piston.start();
  settings.on_row = [&stroke](const Snapshot& row) {
    stroke.force.time.push_back(row.time);
    stroke.force.force.push_back(row.force);
    stroke.key.push_back(row.key_position);
  };
  for (const Event& event : run(action, piston, settings).events)
    if (event.kind == EventKind::hammer_meets_string && stroke.hammer_speed == 0)
      stroke.hammer_speed = event.hammer_speed;
  return stroke;
}

Keystroke intended_by(const FingerSettings& finger, const ReferenceStroke& stroke) {
  // e = X - y:  e' = (F - k e) / d,  with F = F0 + s t exactly e = F / k - s d / k^2 + C exp(-k t / d)
  const double k = finger.stiffness, d = finger.damping;
  const std::vector<double>&t = stroke.force.time, &F = stroke.force.force;
  std::vector<double> intended{stroke.key[0] + F[0] / k};
  double e = F[0] / k;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const double h = t[i + 1] - t[i], slope = (F[i + 1] - F[i]) / h, lag = slope * d / (k * k);
    e = F[i + 1] / k - lag + (e - F[i] / k + lag) * std::exp(-k * h / d);
    intended.push_back(stroke.key[i + 1] + e);
  }
  return {KeystrokeQuantity::position, t, intended};
}

Fidelity fidelity(const ActionFile& action, const ClosedLoopSettings& settings, const ReferenceStroke& stroke) {
  const Keystroke intended = intended_by(settings.rig.finger, stroke);
  const LoopTrace trace = play_loop(action, settings, intended);
  const ForceCurve felt = trace.finger_curve(intended.start());
  Fidelity result;
  result.eta = relative_error(stroke.force, felt, stroke.end);
  long count = 0;
  for (std::size_t i = 0; i < felt.time.size() && felt.time[i] <= stroke.end; ++i, ++count)
    result.rms += std::pow(felt.force[i] - stroke.force.force[i + 1], 2);
  result.rms = std::sqrt(result.rms / static_cast<double>(std::max(count, 1L)));
  result.guarded = trace.guarded;
  result.hammer_speed = trace.hammer_speed / stroke.hammer_speed - 1;
  return result;
}

ActionFile without_lever_mass(const ActionFile& action, double lever_mass) {
  constexpr double kKept = 0.1;  // of the key's inertia
  ActionFile lighter = action;
  Body& key = lighter.model.bodies[static_cast<std::size_t>(lighter.model.finger.body)];
  const double arm = lighter.model.finger.arm;
  key.inertia = std::max(key.inertia - lever_mass * arm * arm, kKept * key.inertia);
  return lighter;
}

}  // namespace erard::study

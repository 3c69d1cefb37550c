#include "erard/device/rig_link.hpp"

#include <algorithm>
#include <cmath>

namespace erard {
namespace {

RigSettings with_seed(RigSettings settings, int key) {
  settings.sensor.seed += static_cast<std::uint64_t>(key);
  return settings;
}

/// Listening need not be real-time here: a late command is what a study of delays wants to see, and is counted.
constexpr ListenerSettings kListening{70};

}  // namespace

RigLink::RigLink(const RigLinkSettings& settings, const Keystroke& intended)
    : settings_(settings),
      command_(static_cast<std::size_t>(settings.keys), 0.0),
      forces_(settings.link.forces_url, settings.link.forces_channel, kListening),
      currents_(settings.link.forces_url, kActuatorChannel, kListening),
      blows_(settings.link.forces_url, kHammerChannel, kListening),
      sender_(settings.link.positions_url),
      intended_(intended) {
  for (int k = 0; k < settings.keys; ++k) rig_.emplace_back(with_seed(settings.rig, k), intended);
  positions_.publisher_id = draw_publisher_id();
  positions_.kind = positions_t::kPiston;
  positions_.key_count = settings.keys;
}

bool RigLink::operator()(const Period& period) noexcept {
  if (start_ns_ == 0) start_ns_ = now_ns_ = period.due_ns;
  take_commands(period.due_ns);
  advance_to(period.due_ns);
  publish(period.due_ns);
  const RigState& state = rig_.front().state();
  view_.time = 1e-9 * static_cast<double>(now_ns_ - start_ns_);
  view_.intended = intended_.at(state.time).value;
  view_.lever = state.lever.position;
  view_.finger_force = state.finger_force;
  view_.command = command_.front();
  shared_.store(view_);
  if (watcher_ != nullptr) watcher_(context_, view_);
  return true;
}

/// All that arrived since the last period, each from its own instant on.
void RigLink::take_commands(std::int64_t now) noexcept {
  Arrival<hammer_event_t> blow;
  for (int i = 0; i < Receiver<hammer_event_t>::kRoom && blows_.take(blow); ++i) {
    ++view_.blows;
    view_.blow_speed = blow.message.speed_m_per_s;
  }
  Arrival<forces_t> force;
  for (int i = 0; i < Receiver<forces_t>::kRoom && forces_.take(force); ++i) {
    view_.faulted = 0;
    for (int k = 0; k < settings_.keys; ++k)
      view_.faulted += force.message.status[k] == forces_t::kFading || force.message.status[k] == forces_t::kFaulted;
    if (settings_.actuator.kind == ActuatorKind::none)
      obey(force.message, force.message.force_N, std::min(force.time_ns, now));
  }
  Arrival<actuator_commands_t> current;
  for (int i = 0; i < Receiver<actuator_commands_t>::kRoom && currents_.take(current); ++i) {
    if (settings_.actuator.kind == ActuatorKind::none) continue;
    for (double& amperes : current.message.current_A) amperes = force_of(amperes);
    obey(current.message, current.message.current_A, std::min(current.time_ns, now));
  }
}

/// @param command  force of each key [N]
template <typename Answer>
void RigLink::obey(const Answer& answer, const double* command, std::int64_t arrival) noexcept {
  if (answer.publisher_id == host_ && answer.sequence <= last_sequence_) return;
  if (answer.key_count != settings_.keys || answer.position_sequence == 0) return;
  host_ = answer.publisher_id;
  last_sequence_ = answer.sequence;
  advance_to(arrival);
  std::copy_n(command, settings_.keys, command_.begin());
  valid_until_ns_ = answer.valid_until_ns;
  ++view_.answers;
  view_.latency = 1e-9 * static_cast<double>(arrival - answer.position_time_ns);
}

/// To an instant with the commands in force; one that has run out is 0 from then on.
void RigLink::advance_to(std::int64_t now) noexcept {
  const auto go = [this](std::int64_t until) noexcept {
    if (until <= now_ns_) return;
    const double seconds = 1e-9 * static_cast<double>(until - now_ns_);
    for (std::size_t k = 0; k < rig_.size(); ++k) rig_[k].advance(seconds, command_[k]);
    now_ns_ = until;
  };
  go(std::min(now, std::max(valid_until_ns_, now_ns_)));
  view_.is_valid = now <= valid_until_ns_;
  if (!view_.is_valid) std::fill(command_.begin(), command_.end(), 0.0);
  go(now);
}

void RigLink::publish(std::int64_t now) noexcept {
  ++positions_.sequence;
  positions_.device_time_ns = now;
  for (std::size_t k = 0; k < rig_.size(); ++k) positions_.position_m[k] = rig_[k].measure();
  static_cast<void>(sender_.publish(settings_.link.positions_channel.c_str(), positions_));
}

/// What the device's amplifier and actuator make of a current, before their delay.
double RigLink::force_of(double current) const noexcept {
  if (settings_.actuator.kind == ActuatorKind::voice_coil)
    return settings_.actuator.voice_coil.force_constant * current;
  const MrBrakeSettings& brake = settings_.actuator.mr_brake;
  return brake.yield_force * -std::expm1(-std::max(0.0, current) / brake.saturation_current);
}

}  // namespace erard

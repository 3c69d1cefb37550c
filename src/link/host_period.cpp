#include "erard/device/host_period.hpp"

#include <algorithm>
#include <cmath>

namespace erard {
namespace {

constexpr Fault kOfActuator = Fault::current_limited | Fault::thermal_limited | Fault::cannot_push;

/// What a look at the memory before it is worth saving: a statistic is not.
constexpr Fault kWorthSaving = Fault::no_input | Fault::step_not_finite | Fault::implausible_speed |
                               Fault::not_finite_input | Fault::period_missed;

std::int8_t kind_of(DriveKind drive) { return drive == DriveKind::key ? positions_t::kKey : positions_t::kPiston; }

/// A device on this machine reads the same clock: its sample is younger than a second and not of the future.
bool shares_clock(std::int64_t device_time_ns, std::int64_t arrival_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
  return device_time_ns <= arrival_ns && arrival_ns - device_time_ns < kSecond;
}

}  // namespace

PositionMessage position_message(const positions_t& p) noexcept {
  const auto keys = static_cast<std::size_t>(std::clamp(p.key_count, 0, static_cast<int>(positions_t::kMaxKeys)));
  return {static_cast<std::uint64_t>(p.publisher_id), p.sequence, p.device_time_ns, std::span(p.position_m, keys)};
}

HostPeriod::HostPeriod(const DeviceSettings& settings, Receiver<positions_t>& positions, Sender& sender,
                       Renderer& renderer, Recorder& recorder, PeriodicLoop<>& loop, HostPace pace)
    : settings_(settings),
      positions_(positions),
      sender_(sender),
      renderer_(renderer),
      recorder_(recorder),
      loop_(loop),
      lock_({loop.settings().period_ns, pace == HostPace::clock ? 1000LL * settings.real_time.phase_us : 0}),
      pace_(pace),
      publisher_(draw_publisher_id()),
      validity_ns_(static_cast<std::int64_t>(std::llround(1e9 * settings.rendering.watch.timeout))) {
  forces_ = {};
  commands_ = {};
  blow_ = {};
  forces_.key_count = commands_.key_count = renderer.size();
  forces_.publisher_id = commands_.publisher_id = blow_.publisher_id = publisher_;
  commands_.actuator = settings.rendering.actuator.kind == ActuatorKind::mr_brake ? actuator_commands_t::kMrBrake
                                                                                  : actuator_commands_t::kVoiceCoil;
  static_cast<void>(sender_.publish(settings_.link.forces_channel.c_str(), forces_));
  for (int i = 0; i < kRoom && positions_.take(arrived_[0]); ++i) {
  }
  before_ = positions_.counts();
}

bool HostPeriod::operator()(const Period& period) noexcept {
  trouble_ = Fault::none;
  is_letting_go_ = is_to_let_go_.load(std::memory_order_relaxed);
  take_positions();
  if (is_letting_go_) arrived_count_ = 0;
  const PeriodOutput& out =
      renderer_.period({period.woke_ns, std::span(message_).first(static_cast<std::size_t>(arrived_count_))});
  publish(out);
  record(out);
  tell(period, out);
  show(period, out);
  steer(period);
  return !(is_letting_go_ && is_gone(out));
}

/// All forces are zero and will stay so.
bool HostPeriod::is_gone(const PeriodOutput& out) const noexcept {
  return std::all_of(out.key.begin(), out.key.end(),
                     [](const KeyOutput& key) { return key.fade == 0 && key.force == 0; });
}

/// All that came since the last period, as it came; what is of another kind than the drive is left out.
void HostPeriod::take_positions() noexcept {
  arrived_count_ = 0;
  for (int i = 0; i < kRoom; ++i) {
    Arrival<positions_t>& arrival = arrived_[static_cast<std::size_t>(arrived_count_)];
    if (!positions_.take(arrival)) break;
    const positions_t& p = arrival.message;
    if (p.kind != kind_of(settings_.rendering.tick.drive)) {
      trouble_ |= Fault::wrong_type;
      continue;
    }
    message_[static_cast<std::size_t>(arrived_count_++)] = position_message(p);
  }
  const ReceiverCounts counts = received();
  const std::int64_t malformed = counts.wrong_type + counts.wrong_size;
  if (malformed > malformed_) trouble_ |= Fault::wrong_type;
  if (counts.overflow > overflow_) trouble_ |= Fault::overflow;
  malformed_ = malformed;
  overflow_ = counts.overflow;
}

/// What forces and commands begin with.
template <typename Message>
void HostPeriod::head(Message& message, const PeriodOutput& out) const noexcept {
  ++message.sequence;
  message.device_time_ns = out.host_time;
  message.position_sequence = position_sequence_;
  message.position_time_ns = position_time_ns_;
  message.valid_until_ns = out.host_time + validity_ns_;
  message.fault_bits = static_cast<std::int32_t>(out.faults | trouble_);
}

void HostPeriod::publish(const PeriodOutput& out) noexcept {
  if (out.used != nullptr) {
    position_sequence_ = out.used->sequence;
    position_time_ns_ = out.used->device_time;
  }
  head(forces_, out);
  for (std::size_t k = 0; k < out.key.size(); ++k) {
    const KeyOutput& key = out.key[k];
    forces_.force_N[k] = key.force;
    forces_.status[k] = key.fade <= 0                                         ? forces_t::kFaulted
                        : key.fade < 1                                        ? forces_t::kFading
                        : renderer_.keyboard().is_asleep(static_cast<int>(k)) ? forces_t::kAsleep
                                                                              : forces_t::kAwake;
  }
  if (!sender_.publish(settings_.link.forces_channel.c_str(), forces_)) trouble_ |= Fault::publish_failed;
  const std::int64_t sent = MonotonicClock{}.now();
  if (out.used != nullptr && shares_clock(position_time_ns_, sent))
    latency_.add(1e-9 * static_cast<double>(sent - position_time_ns_));
  if (settings_.rendering.actuator.kind != ActuatorKind::none) publish_commands(out);
  if (!out.blow.empty()) publish_blows(out);
}

void HostPeriod::publish_commands(const PeriodOutput& out) noexcept {
  head(commands_, out);
  for (std::size_t k = 0; k < out.key.size(); ++k) {
    commands_.current_A[k] = out.key[k].current;
    commands_.expected_force_N[k] = out.key[k].expected_force;
  }
  if (!sender_.publish(kActuatorChannel, commands_)) trouble_ |= Fault::publish_failed;
}

/// The clock of the actions stands still while the host is stopped; told is the end of the period that saw the blow.
void HostPeriod::publish_blows(const PeriodOutput& out) noexcept {
  for (const HammerEvent& blow : out.blow) {
    ++blow_.sequence;
    const double ago = renderer_.keyboard().time() - blow.time;
    blow_.impact_time_ns = out.host_time - std::llround(1e9 * ago);
    blow_.key = blow.key;
    blow_.speed_m_per_s = blow.speed;
    news_.last_blow_speed = blow.speed;
    ++news_.blows;
    if (!sender_.publish(kHammerChannel, blow_)) trouble_ |= Fault::publish_failed;
  }
}

/// Messages first, then the forces that answer them: what belongs together stands together.
void HostPeriod::record(const PeriodOutput& out) noexcept {
  const auto keep = [this](int channel, std::int64_t time, const auto& message) noexcept {
    const int size = message.encode(encoded_.data(), 0, static_cast<int>(encoded_.size()));
    if (size > 0)
      recorder_.push(channel, time, std::as_bytes(std::span(encoded_).first(static_cast<std::size_t>(size))));
  };
  for (int i = 0; i < arrived_count_; ++i)
    keep(kRecordedPositions, arrived_[static_cast<std::size_t>(i)].time_ns,
         arrived_[static_cast<std::size_t>(i)].message);
  keep(kRecordedForces, out.host_time, forces_);
}

void HostPeriod::tell(const Period& period, const PeriodOutput& out) noexcept {
  const std::int64_t missed = loop_.missed();
  if (missed > missed_ || period.skipped > 0) trouble_ |= Fault::period_missed;
  missed_ = missed;
  Fault now = out.faults | trouble_;
  if (is_letting_go_) now = now & ~Fault::no_input;  // it was not listened to
  const Fault begun = now & ~news_.now;
  news_.faults = renderer_.counters();
  news_.host_faults.add(trouble_);
  for (int i = 0; i < kFaultCount; ++i)
    news_.begun[static_cast<std::size_t>(i)] += has(begun, static_cast<Fault>(1u << i)) ? 1 : 0;
  news_.now = now;
  news_.ever |= now;
  news_.has_input = news_.has_input || out.has_input;
  news_.asleep = out.asleep;
  news_.accepted = renderer_.accepted_messages();
  news_.lost = static_cast<std::int64_t>(renderer_.lost_messages());
  news_.passivity_periods += has(now, Fault::passivity_acted) ? 1 : 0;
  news_.force_limit_periods += has(now, Fault::force_limited) ? 1 : 0;
  news_.slew_limit_periods += has(now, Fault::slew_limited) ? 1 : 0;
  news_.actuator_limit_periods += has(now, kOfActuator) ? 1 : 0;
  news_.is_fading = false;
  for (std::size_t k = 0; k < out.key.size(); ++k) {
    const double force = out.key[k].force;
    news_.largest_force = std::max(news_.largest_force, std::abs(force));
    news_.largest_change = std::max(news_.largest_change, std::abs(force - force_before_[k]));
    news_.is_fading = news_.is_fading || out.key[k].fade < 1;
    force_before_[k] = force;
  }
  news_shared_.store(news_);
  if (news_.has_input && has(begun, kWorthSaving)) recorder_.report_fault();
}

/// One key after the other, so that a period costs the same with 88.
void HostPeriod::show(const Period& period, const PeriodOutput& out) noexcept {
  KeyView view;
  view.key = static_cast<int>(period.number % renderer_.size());
  view.time_ns = out.host_time;
  const State state = renderer_.keyboard().state(view.key);
  std::copy(state.x.begin(), state.x.end(), view.x.begin());
  std::copy(state.compression.begin(), state.compression.end(), view.compression.begin());
  view.piston = out.key[static_cast<std::size_t>(view.key)].piston.value;
  view.force = out.key[static_cast<std::size_t>(view.key)].force;
  view_shared_.store(view);
}

/// Keeps the grid at the chosen delay behind the device: behind its samples where it reads the same clock, else behind
/// the arrival of its messages; or at that arrival, where it begins the periods.
void HostPeriod::steer(const Period& period) noexcept {
  if (arrived_count_ == 0) return;
  const Arrival<positions_t>& newest = arrived_[static_cast<std::size_t>(arrived_count_ - 1)];
  const std::int64_t device_time = newest.message.device_time_ns;
  if (pace_ == HostPace::messages)
    loop_.shift(lock_.shift_onto(period.due_ns, newest.time_ns));
  else
    loop_.shift(lock_.shift(period.due_ns, shares_clock(device_time, newest.time_ns) ? device_time : newest.time_ns));
}

}  // namespace erard

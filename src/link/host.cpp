#include "erard/device/host.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "erard/device/host_status.hpp"

namespace erard {
namespace {

LoopSettings loop_settings(const DeviceSettings& settings) {
  LoopSettings loop;
  loop.period_ns = std::llround(1e9 * settings.rendering.tick.period);
  loop.late_bound_ns = std::min(loop.late_bound_ns, loop.period_ns / 2);
  return loop;
}

RecorderSettings recorder_settings(const DeviceSettings& settings, const HostOptions& options) {
  constexpr double kHistory = 5, kAfterFault = 0.5;  // [s]
  constexpr double kEventsAPeriod = 2;
  const double rate = 1 / settings.rendering.tick.period;
  RecorderSettings recorder;
  recorder.channels = {settings.link.positions_channel, settings.link.forces_channel};
  recorder.history_events = static_cast<std::size_t>(kEventsAPeriod * kHistory * rate);
  recorder.events_after_fault = static_cast<std::size_t>(kEventsAPeriod * kAfterFault * rate);
  recorder.fault_folder = options.fault_folder;
  recorder.session_file = options.record;
  recorder.session = options.session;
  return recorder;
}

/// Below the loop, so that no flood of messages stops it, and above every ordinary thread.
ListenerSettings listener_settings(const DeviceSettings& settings) {
  const int priority = settings.real_time.priority;
  return {priority == 0 ? 0 : std::max(1, priority - 10)};
}

/// Worst wake-up out of a hundred short sleeps [ns].
std::int64_t measure_jitter() {
  constexpr int kSleeps = 100;
  constexpr std::int64_t kSleep = 500'000;  // [ns]
  const MonotonicClock clock;
  std::int64_t worst = 0, due = clock.now();
  for (int i = 0; i < kSleeps; ++i) {
    due += kSleep;
    clock.sleep_until(due);
    worst = std::max(worst, clock.now() - due);
  }
  return worst;
}

}  // namespace

Host::Host(const ActionFile& action, const DeviceSettings& settings, const HostOptions& options)
    : settings_(settings),
      options_(options),
      renderer_(std::make_unique<Renderer>(action.model, action.roles, settings.rendering)),
      recorder_(recorder_settings(settings, options)),
      receiver_(settings.link.positions_url, settings.link.positions_channel, listener_settings(settings)),
      force_sender_(settings.link.forces_url),
      status_sender_(settings.link.forces_url),
      loop_(loop_settings(settings)) {
  if (options_.make_player) {
    player_ = options_.make_player(renderer_->keyboard());
    renderer_->play_by(player_.get());
  }
  thread_ = std::thread([this] { work(); });
  asked_.get_future().wait();
  const int listening = receiver_.listener().granted_priority();
  const ListenerSettings wanted = listener_settings(settings);
  if (wanted.priority > 0)
    grants_.push_back({"listening thread", fmt::format("SCHED_FIFO {}", wanted.priority),
                       listening > 0 ? fmt::format("SCHED_FIFO {}", listening) : "ordinary scheduling",
                       listening == wanted.priority, listening == wanted.priority ? "" : "as for the scheduler above"});
  grants_.push_back({"timer jitter", "below 500 us", fmt::format("{} us, the worst of 100", jitter_ns_ / 1000),
                     jitter_ns_ < 500'000, jitter_ns_ < 500'000 ? "" : "look for what takes the CPU: erard-check"});
}

Host::~Host() {
  stop();
  if (thread_.joinable()) finish();
}

bool Host::is_real_time() const noexcept {
  return settings_.real_time.priority > 0 &&
         std::all_of(grants_.begin(), grants_.end(), [](const Grant& grant) { return grant.is_granted; });
}

void Host::go() {
  if (is_answered_) return;
  is_answered_ = true;
  answer_.set_value(true);
  begun_.get_future().wait();
}

void Host::stop() noexcept {
  if (period_)
    period_->let_go();
  else
    loop_.stop();
}

LoopSummary Host::finish() {
  if (!is_answered_) {
    is_answered_ = true;
    answer_.set_value(false);
  }
  if (thread_.joinable()) thread_.join();
  recorder_.finish();
  is_over_ = true;
  return summary_;
}

/// The real-time thread.
void Host::work() {
  std::optional<RealTime> real_time;
  if (settings_.real_time.priority > 0) {
    real_time.emplace(RealTimeRequest{settings_.real_time.priority, settings_.real_time.cpu});
    grants_ = real_time->grants();
  }
  jitter_ns_ = measure_jitter();
  asked_.set_value();
  if (!answer_.get_future().get()) return;
  period_ =
      std::make_unique<HostPeriod>(settings_, receiver_, force_sender_, *renderer_, recorder_, loop_, options_.pace);
  prctl(PR_SET_NAME, "erard-loop");  // until it has another name: no heap, no lock
  begun_.set_value();
  if (options_.pace == HostPace::messages) {
    // One that is early waits: half a period before the clock is the earliest, or a fast device would hasten the
    // simulation. One that is late is waited for: half a period, then the period goes without.
    const std::int64_t tolerance = loop_.settings().period_ns / 2;
    summary_ = loop_.run(*period_, [this, tolerance](std::int64_t due) noexcept {
      MonotonicClock{}.sleep_until(due - tolerance);
      receiver_.wait(due + tolerance);
      return due;  // the clock goes on, led by the period's work
    });
  } else {
    summary_ = loop_.run(*period_);
  }
  prctl(PR_SET_NAME, "erard-ending");
}

HostNews Host::news() const {
  HostNews news = period_ ? period_->news() : HostNews{};
  if (recorder_.status().trouble.empty()) return news;
  news.now |= Fault::recording_stopped;
  news.ever |= Fault::recording_stopped;
  news.begun[std::countr_zero(static_cast<std::uint32_t>(Fault::recording_stopped))] = 1;
  return news;
}

host_status_t Host::status() const {
  host_status_t status{};
  const HostNews news = this->news();
  status.publisher_id = period_ ? period_->publisher_id() : 0;
  status.device_time_ns = MonotonicClock{}.now();
  status.state = is_over_          ? host_status_t::kStopping
                 : !period_        ? host_status_t::kStarting
                 : !news.has_input ? host_status_t::kWaiting
                 : news.is_fading  ? host_status_t::kFading
                                   : host_status_t::kRunning;
  status.key_count = settings_.rendering.keys;
  const auto is_granted = [this](const char* what) {
    return std::any_of(grants_.begin(), grants_.end(),
                       [what](const Grant& grant) { return grant.what == what && grant.is_granted; });
  };
  status.realtime_priority = is_granted("scheduler") ? settings_.real_time.priority : 0;
  status.memory_locked = is_granted("memory") ? 1 : 0;
  status.cpu = is_granted("CPU") ? settings_.real_time.cpu : -1;
  status.cpu_latency_us = is_granted("CPU sleep") ? 0 : -1;
  status.timer_jitter_ns = jitter_ns_;
  status.period_ns = loop_.settings().period_ns;
  fill_counts(loop(), news, received(), status);
  fill_bins(wake_lateness(), status.wake_latency_count);
  fill_bins(work_time(), status.work_time_count);
  status.fault_bits_now = static_cast<std::int32_t>(news.now);
  status.fault_bits_ever = static_cast<std::int32_t>(news.ever);
  status.dropped_by_kernel = dropped_by_kernel();
  return status;
}

void Host::publish_status() {
  host_status_t told = status();
  told.sequence = ++status_count_;
  status_sender_.publish(kStatusChannel, told);
  if (!period_) return;
  const KeyView view = period_->view();
  action_state_t shown = make_action_state(renderer_->keyboard().mechanism(view.key), view);
  shown.publisher_id = told.publisher_id;
  shown.sequence = ++view_count_;
  status_sender_.publish(kStateChannel, shown);
}

}  // namespace erard

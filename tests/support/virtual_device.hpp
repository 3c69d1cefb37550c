// A device on the link: it tells where its key is, and hears what the finger should feel.
#pragma once

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "erard/device/link.hpp"
#include "host_session.hpp"

namespace erard::test {

/// What came back.
struct Heard {
  std::vector<forces_t> forces;
  std::vector<host_status_t> status;
  std::vector<action_state_t> states;
  std::vector<actuator_commands_t> commands;
  std::vector<hammer_event_t> blows;
};

/// One key, 2000 samples a second on a grid of time. A device that the machine keeps waiting goes on with the sample
/// that is due: its finger has not waited.
class VirtualDevice {
 public:
  using Transmit = std::function<void(const positions_t&, Sender&)>;

  VirtualDevice() : thread_([this] { work(); }) {}
  ~VirtualDevice() {
    is_over_ = true;
    thread_.join();
  }
  VirtualDevice(const VirtualDevice&) = delete;
  VirtualDevice& operator=(const VirtualDevice&) = delete;

  /// The finger: it will go there, one position a sample, and then stay.
  void play(const std::vector<double>& positions) {
    const std::lock_guard lock(mutex_);
    plan_.insert(plan_.end(), positions.begin(), positions.end());
  }
  bool is_still() const {
    const std::lock_guard lock(mutex_);
    return next_ >= plan_.size();
  }

  /// How messages leave; from the next one on.
  void transmit_by(Transmit transmit) {
    const std::lock_guard lock(mutex_);
    transmit_ = std::move(transmit);
  }
  void transmit() {
    transmit_by([](const positions_t& p, Sender& sender) { sender.publish(kPositionsChannel, p); });
  }
  void fall_silent() {
    transmit_by([](const positions_t&, Sender&) {});
  }

  std::vector<Sample> samples() const {
    const std::lock_guard lock(mutex_);
    return samples_;
  }
  Heard heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  forces_t force() const { return last(heard_.forces); }
  host_status_t status() const { return last(heard_.status); }
  action_state_t state() const { return last(heard_.states); }
  std::int64_t publisher() const { return publisher_; }

 private:
  static constexpr std::int64_t kPeriod = 500'000;  // [ns]

  template <typename Message>
  Message last(const std::vector<Message>& all) const {
    const std::lock_guard lock(mutex_);
    return all.empty() ? Message{} : all.back();
  }

  void work() {
    const sched_param above_ordinary_threads{60};
    sched_setscheduler(0, SCHED_FIFO, &above_ordinary_threads);  // where it is granted
    const MonotonicClock clock;
    positions_t positions{};
    positions.publisher_id = publisher_;
    positions.kind = positions_t::kPiston;
    positions.key_count = 1;
    for (std::int64_t due = clock.now(); !is_over_; due += kPeriod) {
      clock.sleep_until(due);
      const std::int64_t late = (clock.now() - due) / kPeriod;  // samples
      due += late * kPeriod;
      const std::lock_guard lock(mutex_);
      next_ = std::min(plan_.size(), next_ + static_cast<std::size_t>(late));
      if (next_ > 0) positions.position_m[0] = plan_[next_ - 1];
      if (next_ < plan_.size()) positions.position_m[0] = plan_[next_++];
      ++positions.sequence;
      positions.device_time_ns = due;
      samples_.push_back({due, positions.position_m[0]});
      transmit_(positions, sender_);
      hear();
    }
  }

  void hear() {
    take(forces_, heard_.forces);
    take(statuses_, heard_.status);
    take(states_, heard_.states);
    take(commands_, heard_.commands);
    take(blows_, heard_.blows);
  }
  template <typename Message>
  static void take(Receiver<Message>& receiver, std::vector<Message>& all) {
    for (Message message; receiver.take(message);) all.push_back(message);
  }

  std::int64_t publisher_ = draw_publisher_id();
  Sender sender_{kDeviceUrl};
  Receiver<forces_t> forces_{kHostUrl, kForcesChannel};
  Receiver<host_status_t> statuses_{kHostUrl, kStatusChannel};
  Receiver<action_state_t> states_{kHostUrl, kStateChannel};
  Receiver<actuator_commands_t> commands_{kHostUrl, kActuatorChannel};
  Receiver<hammer_event_t> blows_{kHostUrl, kHammerChannel};
  mutable std::mutex mutex_;
  Transmit transmit_ = [](const positions_t& p, Sender& sender) { sender.publish(kPositionsChannel, p); };
  std::vector<double> plan_;  // [m]
  std::size_t next_ = 0;
  std::vector<Sample> samples_;
  Heard heard_;
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace erard::test

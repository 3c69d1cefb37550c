// The real-time host: everything between two LCM addresses, and what it tells of itself.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/host_period.hpp"
#include "erard/device/real_time.hpp"

namespace erard {

/// Makes who advances the keys of a host.
using MakePlayer = std::function<std::unique_ptr<KeyboardPlayer>(Keyboard&)>;

struct HostOptions {
  HostPace pace = HostPace::clock;
  std::filesystem::path record;        // file of the session; empty: none
  std::filesystem::path fault_folder;  // of what is saved on a fault; empty: nothing is
  std::string session;                 // text that a recording begins with
  MakePlayer make_player;              // empty: the keyboard advances itself
};

/// Threads: listening (the receiver's), real-time, recording, and the caller's, which asks for status.
///
///     Host host(action, settings, options);  // sockets, files, threads; the real-time thread asks and waits
///     show(host.grants());
///     host.go();                             // from here on positions become forces
///     ... host.publish_status() some ten times a second ...
///     host.stop();                           // no more positions; once the forces have faded the loop ends
class Host {
 public:
  /// Throws InputError or std::runtime_error with the remedy when files, sockets or threads cannot be had. What real
  /// time the kernel refuses is told by grants(), nothing else.
  Host(const ActionFile& action, const DeviceSettings& settings, const HostOptions& options);
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  const std::vector<Grant>& grants() const noexcept { return grants_; }
  bool is_real_time() const noexcept;  // all was granted

  void go();
  void stop() noexcept;  // lets go of all keys: the forces fade, then the loop ends
  /// After stop(): the whole of the run. Waits for the loop's end.
  LoopSummary finish();

  HostNews news() const;  // the recorder's troubles included
  LoopStatus loop() const noexcept { return loop_.status(); }
  DurationHistogram wake_lateness() const noexcept { return loop_.wake_lateness(); }
  DurationHistogram work_time() const noexcept { return loop_.work_time(); }
  DurationHistogram latency() const noexcept { return period_ ? period_->latency() : DurationHistogram{}; }
  ReceiverCounts received() const noexcept { return period_ ? period_->received() : ReceiverCounts{}; }
  std::int64_t dropped_by_kernel() const noexcept { return receiver_.listener().dropped_by_kernel(); }
  RecorderStatus recorder() const { return recorder_.status(); }
  const DeviceSettings& settings() const noexcept { return settings_; }

  /// Publishes host_status_t and one key as action_state_t. From the thread that made the host.
  void publish_status();

 private:
  void work();
  host_status_t status() const;

  DeviceSettings settings_;
  HostOptions options_;
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<KeyboardPlayer> player_;
  Recorder recorder_;
  Receiver<positions_t> receiver_;
  Sender force_sender_, status_sender_;
  PeriodicLoop<> loop_;
  std::unique_ptr<HostPeriod> period_;  // made by the real-time thread before it runs
  std::vector<Grant> grants_;
  std::int64_t jitter_ns_ = 0;  // worst wake-up before the start [ns]
  std::int64_t status_count_ = 0, view_count_ = 0;
  std::promise<void> asked_;   // by the real-time thread: grants_ is there
  std::promise<bool> answer_;  // to it: run, or end
  std::promise<void> begun_;   // by it: period_ is there
  bool is_answered_ = false, is_over_ = false;
  LoopSummary summary_;
  std::thread thread_;
};

}  // namespace erard

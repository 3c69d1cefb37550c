// A recorded session of the host: what must hold in every one, and what it would have been without a fault.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <vector>

#include "erard/device/host_period.hpp"
#include "erard/device/session.hpp"

namespace erard::test {

struct RecordedPeriod {
  std::vector<positions_t> arrived;
  forces_t forces;

  std::int64_t time() const { return forces.device_time_ns; }  // of the host [ns]
  double force() const { return forces.force_N[0]; }
};

struct RecordedSession {
  SessionParts parts;
  std::vector<RecordedPeriod> periods;

  const RenderSettings& rendering() const { return parts.settings.rendering; }
};

RecordedSession read_session(const std::filesystem::path& file);

/// What holds in every session: nothing restarts, no force is above the limit, none changes quicker than it may.
void expect_safe(const RecordedSession& session);
/// The same of what a device heard of it: messages may be missing.
void expect_safe(const std::vector<forces_t>& all, const GuardSettings& guard, double period = 5e-4);

/// Where no good position came for the timeout, the force is on its way to zero and gets there in the fade's time.
/// Both by the host's own clock and count: a machine that is slow does not count.
/// @return periods in which it was zero for that reason
int expect_fades_in_silence(const RecordedSession& session);

/// Instants of the host [ns], both included.
struct Window {
  std::int64_t from = 0, to = std::numeric_limits<std::int64_t>::max();

  bool holds(std::int64_t time) const { return time >= from && time <= to; }
};

/// A sample as it was taken, whatever became of its message.
struct Sample {
  std::int64_t time_ns = 0;
  double position = 0;  // [m]
};

/// Samples that should have come in a period, in order; asked of every period, one after the other.
using Truth = std::function<std::vector<Sample>(const RecordedPeriod&)>;

/// What a device meant to tell: each of its samples once, in order. Those whose messages came in order come when they
/// did: what the machine kept waiting waits here too. The others, never heard or overtaken, come when they were due.
class Meant {
 public:
  /// @param samples  message n told of sample n - 1, or should have
  Meant(const RecordedSession& session, std::int64_t publisher, std::vector<Sample> samples);

  std::vector<Sample> operator()(const RecordedPeriod& period);

 private:
  std::int64_t publisher_;
  std::vector<Sample> samples_;
  std::vector<bool> came_;   // of each sample: in order
  std::int64_t newest_ = 0;  // sequence that came so far
  std::size_t told_ = 0;     // samples
};

struct Computed {
  std::vector<double> force;     // of each period [N]
  std::vector<bool> is_settled;  // of each period: all of the force was there for the last 50 ms
  std::vector<double> blow;      // speed of each hammer that met its string [m/s]
};

/// The session once more, with the truth in the window, as if nothing had happened there. Outside of it what arrived is
/// taken as it arrived: what the machine did to both is the same.
Computed undisturbed(const RecordedSession& session, Window window, const Truth& truth);

/// Of the forces in a window [N]; infinite where there are none.
struct ForceDifference {
  double largest = 0, rms = 0;
  double reference_rms = 0;  // of the force as it should have been
};
/// Where the machine kept every message waiting for longer than the timeout, the force as it should have been fades
/// too: until it has settled again, nothing can be told.
ForceDifference difference(const RecordedSession& session, const Computed& reference, Window window);

}  // namespace erard::test

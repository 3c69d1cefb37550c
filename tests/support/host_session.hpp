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

/// Positions that should have come in a period, in order [m].
using Truth = std::function<std::vector<double>(const RecordedPeriod&)>;

struct Computed {
  std::vector<double> force;  // of each period [N]
  std::vector<double> blow;   // speed of each hammer that met its string [m/s]
};

/// The session once more, with the truth in the window, as if nothing had happened there. Outside of it what arrived is
/// taken as it arrived: what the machine did to both is the same.
Computed undisturbed(const RecordedSession& session, Window window, const Truth& truth);

/// Of the forces in a window [N]; infinite where there are none.
struct Difference {
  double largest = 0, rms = 0;
};
Difference difference(const RecordedSession& session, const std::vector<double>& reference, Window window);

}  // namespace erard::test

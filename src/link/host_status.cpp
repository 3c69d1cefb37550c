#include "erard/device/host_status.hpp"

#include <algorithm>
#include <cmath>

#include "erard/haptics/finger.hpp"

namespace erard {

void fill_bins(const DurationHistogram& histogram, std::int64_t (&bins)[host_status_t::kTimeBins]) {
  std::fill(std::begin(bins), std::end(bins), 0);
  for (std::size_t i = 0; i < DurationHistogram::kBins; ++i) {
    if (histogram.count(i) == 0) continue;
    const double us = 1e6 * DurationHistogram::lower_edge(i);
    const double bin = us < 1 ? 0 : 1 + std::floor(2 * std::log2(us));
    bins[static_cast<int>(std::min(bin, static_cast<double>(host_status_t::kTimeBins) - 1))] += histogram.count(i);
  }
}

void fill_counts(const LoopStatus& loop, const HostNews& news, const ReceiverCounts& received, host_status_t& status) {
  status.periods = loop.periods;
  status.missed_woke_late = loop.missed_by(MissCause::woke_late);
  status.missed_worked_long = loop.missed_by(MissCause::worked_long);
  status.missed_interrupted = loop.missed_by(MissCause::interrupted);
  std::copy(news.begun.begin(), news.begun.end(), status.fault_count);
  status.positions_accepted = news.accepted;
  status.dropped_lost = news.lost;
  status.dropped_duplicate = news.faults[Fault::duplicate];
  status.dropped_reordered = news.faults[Fault::reordered];
  status.dropped_not_finite = news.faults[Fault::not_finite_input];
  status.dropped_out_of_range = news.faults[Fault::out_of_range];
  status.dropped_implausible_speed = news.faults[Fault::implausible_speed];
  status.dropped_wrong_type = received.wrong_type;
  status.dropped_wrong_size = received.wrong_size + news.faults[Fault::wrong_size];
  status.dropped_foreign_publisher = news.faults[Fault::foreign_publisher];
  status.dropped_late = news.faults[Fault::stale_time];
  status.dropped_overflow = received.overflow;
  status.passivity_periods = news.passivity_periods;
  status.force_limit_periods = news.force_limit_periods;
  status.slew_limit_periods = news.slew_limit_periods;
  status.actuator_limit_periods = news.actuator_limit_periods;
}

action_state_t make_action_state(const Mechanism& mechanism, const KeyView& view) {
  action_state_t shown{};
  Frames frames;
  ContactFrames contacts;
  place_bodies(mechanism.model, view.x, frames);
  locate_contacts(mechanism, view.x, frames, contacts);
  shown.key = view.key;
  shown.device_time_ns = view.time_ns;
  shown.body_count = std::min(mechanism.body_count(), static_cast<int>(action_state_t::kMaxBodies));
  for (int i = 0; i < shown.body_count; ++i) {
    const bool turns = mechanism.model.bodies[i].joint == JointKind::hinge;
    shown.angle_rad[i] = turns ? frames.body[i].angle : view.x[i];
  }
  shown.contact_count = std::min(mechanism.contact_count(), static_cast<int>(action_state_t::kMaxContacts));
  for (int c = 0; c < shown.contact_count; ++c) {
    const int felt = mechanism.felt_coordinate[c];
    const double gap = contacts[c].gap, compression = felt < 0 ? view.compression[c] : view.x[felt];
    shown.compression_m[c] = gap > 0 ? -gap : std::max(compression, -gap);
  }
  const Finger& finger = mechanism.model.finger;
  shown.position_m = view.piston;
  shown.key_position_m = -finger.arm * (view.x[finger.body] - mechanism.model.bodies[finger.body].initial);
  shown.force_N = view.force;
  return shown;
}

}  // namespace erard

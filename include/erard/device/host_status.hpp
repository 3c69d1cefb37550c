// What the host tells watchers and viewers, as messages.
#pragma once

#include "erard/action_state_t.hpp"
#include "erard/device/duration_histogram.hpp"
#include "erard/device/host_period.hpp"
#include "erard/host_status_t.hpp"

namespace erard {

/// Counts in the bins of host_status_t: bin 0 below 1 us, bin i from 2^((i-1)/2) to 2^(i/2) us, the last one all above.
/// The histogram's own bins of 1 % go where their lower edge lies.
void fill_bins(const DurationHistogram& histogram, std::int64_t (&bins)[host_status_t::kTimeBins]);

/// Counts of the loop and of the input.
void fill_counts(const LoopStatus& loop, const HostNews& news, const ReceiverCounts& received, host_status_t& status);

/// A key as viewers want it: angles absolute, gaps of open contacts negative.
action_state_t make_action_state(const Mechanism& mechanism, const KeyView& view);

}  // namespace erard

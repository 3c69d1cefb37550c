#include "host_session.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "erard/device/event_log.hpp"

namespace erard::test {

RecordedSession read_session(const std::filesystem::path& file) {
  EventLogReader log(file);
  const LogEvent first = log.next().value();
  RecordedSession session{load_session(session_from_text(session_text(first, file), file.string())), {}};
  const LinkSettings& link = session.parts.settings.link;
  RecordedPeriod period;
  while (const std::optional<LogEvent> event = log.next()) {
    const int size = static_cast<int>(event->data.size());
    EXPECT_NE(event->channel, Recorder::kLost);
    if (event->channel == link.positions_channel)
      period.arrived.emplace_back().decode(event->data.data(), 0, size);
    else if (event->channel == link.forces_channel) {
      period.forces.decode(event->data.data(), 0, size);
      session.periods.push_back(std::move(period));
      period = {};
    }
  }
  return session;
}

void expect_safe(const std::vector<forces_t>& all, const GuardSettings& guard, double period) {
  constexpr double kRounding = 1e-12;  // [N] a thousand times that of a sum of forces
  ASSERT_FALSE(all.empty());
  const forces_t* before = nullptr;
  for (const forces_t& forces : all) {
    const double force = forces.force_N[0];
    ASSERT_TRUE(std::isfinite(force));
    ASSERT_LE(std::abs(force), guard.max_force);
    if (before != nullptr) {
      ASSERT_EQ(forces.publisher_id, before->publisher_id);
      ASSERT_GT(forces.sequence, before->sequence);
      ASSERT_GT(forces.device_time_ns, before->device_time_ns);
      const auto periods = static_cast<double>(forces.sequence - before->sequence);
      ASSERT_LE(std::abs(force - before->force_N[0]), periods * guard.max_slew * period + kRounding) << forces.sequence;
    }
    before = &forces;
  }
}

void expect_safe(const RecordedSession& session) {
  std::vector<forces_t> all;
  for (const RecordedPeriod& period : session.periods) all.push_back(period.forces);
  ASSERT_FALSE(all.empty());
  ASSERT_EQ(all.back().sequence - all.front().sequence + 1, static_cast<std::int64_t>(all.size()));
  expect_safe(all, session.rendering().guard, session.rendering().tick.period);
}

int expect_fades_in_silence(const RecordedSession& session) {
  const RenderSettings& r = session.rendering();
  // the fade takes so many periods; behind it the slew limit may take as many as from all to nothing
  const int most = static_cast<int>(std::ceil(r.guard.fade_time / r.tick.period) +
                                    std::ceil(r.guard.max_force / (r.guard.max_slew * r.tick.period)));
  std::int64_t last_good = 0;
  int silent = 0, zero = 0;
  for (const RecordedPeriod& period : session.periods) {
    for (const positions_t& p : period.arrived)
      if (p.sequence == period.forces.position_sequence && p.position_m[0] >= r.watch.lowest &&
          p.position_m[0] <= r.watch.highest)
        last_good = period.time();
    silent = static_cast<double>(period.time() - last_good) > 1e9 * r.watch.timeout ? silent + 1 : 0;
    if (silent > most) {
      EXPECT_EQ(period.force(), 0) << "period " << period.forces.sequence;
      EXPECT_EQ(period.forces.status[0], forces_t::kFaulted);
      ++zero;
    }
  }
  return zero;
}

Meant::Meant(const RecordedSession& session, std::int64_t publisher, std::vector<Sample> samples)
    : publisher_(publisher), samples_(std::move(samples)), came_(samples_.size()) {
  std::int64_t newest = 0;
  for (const RecordedPeriod& period : session.periods)
    for (const positions_t& p : period.arrived) {
      if (p.publisher_id != publisher_ || p.sequence <= newest) continue;
      newest = p.sequence;
      came_.at(static_cast<std::size_t>(newest - 1)) = true;
    }
}

std::vector<Sample> Meant::operator()(const RecordedPeriod& period) {
  constexpr std::int64_t kTransit = 100'000;  // [ns] of a message that is not kept waiting, and less than the phase
  for (const positions_t& p : period.arrived)
    if (p.publisher_id == publisher_) newest_ = std::max(newest_, p.sequence);
  const auto is_there = [&](std::size_t i) {
    return came_[i] ? static_cast<std::int64_t>(i) < newest_ : samples_[i].time_ns + kTransit <= period.time();
  };
  std::vector<Sample> now;
  while (told_ < samples_.size() && is_there(told_)) now.push_back(samples_[told_++]);
  return now;
}

Computed undisturbed(const RecordedSession& session, Window window, const Truth& truth) {
  constexpr int kSettling = 100;  // [periods] recovery_samples, a jump of four of them, and the fade
  Renderer renderer(session.parts.action.model, session.parts.action.roles, session.rendering());
  Computed computed;
  std::int64_t sequence = 0, offset = 0;
  bool was_inside = false;
  int whole = 0;  // periods in a row
  for (const RecordedPeriod& period : session.periods) {
    std::vector<positions_t> arrived = period.arrived;
    const std::vector<Sample> meant = truth(period);
    if (window.holds(period.time())) {
      was_inside = true;
      arrived.clear();
      for (const Sample& sample : meant) {
        positions_t& p = arrived.emplace_back();
        p.sequence = sequence + static_cast<std::int64_t>(arrived.size());
        p.device_time_ns = sample.time_ns;
        p.key_count = 1;
        p.position_m[0] = sample.position;
      }
    } else if (!arrived.empty()) {
      if (was_inside) offset = sequence + 1 - arrived[0].sequence;
      was_inside = false;
      for (positions_t& p : arrived) p.sequence += offset;
    }
    std::vector<PositionMessage> messages;
    for (positions_t& p : arrived) {
      p.publisher_id = 1;
      sequence = std::max(sequence, p.sequence);
      messages.push_back(position_message(p));
    }
    const PeriodOutput& out = renderer.period({period.time(), messages});
    whole = out.key[0].fade == 1 ? whole + 1 : 0;
    computed.force.push_back(out.key[0].force);
    computed.is_settled.push_back(whole > kSettling);
    for (const HammerEvent& blow : out.blow) computed.blow.push_back(blow.speed);
  }
  return computed;
}

ForceDifference difference(const RecordedSession& session, const Computed& reference, Window window) {
  ForceDifference result;
  double square = 0, reference_square = 0;
  int count = 0;
  for (std::size_t i = 0; i < reference.force.size(); ++i) {
    if (!window.holds(session.periods[i].time()) || !reference.is_settled[i]) continue;
    const double off = std::abs(session.periods[i].force() - reference.force[i]);
    result.largest = std::max(result.largest, off);
    square += off * off;
    reference_square += reference.force[i] * reference.force[i];
    ++count;
  }
  if (count == 0) return {HUGE_VAL, HUGE_VAL, 0};
  return {result.largest, std::sqrt(square / count), std::sqrt(reference_square / count)};
}

}  // namespace erard::test

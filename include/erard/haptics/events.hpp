// The events of a keystroke, found while it is played.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "erard/haptics/finger.hpp"
#include "erard/mechanics/contact_frames.hpp"

namespace erard {

/// Which contacts and bodies of a mechanism play the parts that events speak of; -1 where it has none.
struct ActionRoles {
  int let_off = -1;     // contact jack - let-off button (JG)
  int escapement = -1;  // contact jack top - knuckle (JH)
  int front_rail = -1;  // contact key - front rail punching (KS+)
  int string = -1;      // contact hammer - string (HG)
  int backcheck = -1;   // contact backcheck - hammer tail (KH)
  int jack_rest = -1;   // contact jack - its regulating screw (WJ)
  int hammer = -1;      // body
};

enum class EventKind {
  jack_meets_let_off,    // first force at the let-off button                                thesis 6.4.1 (b)
  escapement,            // jack top leaves the knuckle for the last time before the string is hit
  key_meets_front_rail,  // first force at the front rail punching                           thesis (c)
  hammer_meets_string,   // force at the string appears, 10 ms lock-out                      thesis (d)
  hammer_checked,        // first force at the backcheck after an impact                     thesis (e)
  jack_returned,         // the jack lies on its screw again and is free of the button       thesis (f)
  repetition_ready,      // the jack's top is under the knuckle again: the knuckle's centre, seen across the top,
                         // lies between the two corners
};

inline constexpr const char* name_of(EventKind kind) noexcept {
  constexpr std::array names{"jack_meets_let_off", "escapement",    "key_meets_front_rail", "hammer_meets_string",
                             "hammer_checked",     "jack_returned", "repetition_ready"};
  return names[static_cast<std::size_t>(kind)];
}

struct Event {
  EventKind kind = EventKind::jack_meets_let_off;
  double time = 0;  // end of the step that saw it [s]
  int strike = 1;
  double hammer_speed = 0;  // |omega_H| times the radius of the head circle's centre, of the step before [m/s]
  double key_position = 0;  // y [m]
  double force = 0;         // of the finger [N]
};

/// Finds events from step to step; in place, noexcept. Of a run with more than kCapacity events the later ones are
/// counted but not kept.
class EventDetector {
 public:
  static constexpr int kCapacity = 512;

  EventDetector(const Mechanism& mechanism, const ActionRoles& roles) noexcept : mechanism_(&mechanism), roles_(roles) {
    if (roles.hammer != kGround && roles.string >= 0) {
      const Contact& string = mechanism.model.contacts[roles.string];
      hammer_radius_ = (string.body_a == roles.hammer ? string.shape_a : string.shape_b).centre.norm();
    }
    for (int c = 0; c < mechanism.contact_count(); ++c) normal_row_[c] = mechanism.normal_row[c];
  }

  /// Looks at the state after one internal step. @param force of the finger [N]
  void observe(const State& state, double force) noexcept {
    const Sight now{touches(state, roles_.let_off),    touches(state, roles_.escapement),
                    touches(state, roles_.front_rail), touches(state, roles_.string),
                    touches(state, roles_.backcheck),  touches(state, roles_.jack_rest)};
    const Event here{EventKind::escapement,
                     state.time,
                     strike_,
                     hammer_speed_,
                     mechanism_->model.finger.body == kGround ? 0.0 : key_position(mechanism_->model, state),
                     force};
    see_descent(now, here);
    see_string(now, here);
    see_return(now, here, is_jack_under_knuckle(state));
    before_ = now;
    hammer_speed_ = roles_.hammer == kGround ? 0.0 : hammer_radius_ * std::abs(hammer_rate(state));
  }

  /// Ends the run: a press that did not reach the string gets its escapement here, the last one it had.
  void finish() noexcept { settle_escapement(); }

  int count() const noexcept { return count_ < kCapacity ? count_ : kCapacity; }
  int seen() const noexcept { return count_; }
  const Event& operator[](int i) const noexcept { return event_[i]; }
  double hammer_speed() const noexcept { return hammer_speed_; }  // [m/s]

 private:
  struct Sight {  // contacts with a force
    bool let_off = false, escapement = false, front_rail = false, string = false, backcheck = false, jack_rest = false;
  };

  static constexpr double kLockOut = 0.010;      // [s] between two impacts; shorter ones are one blow
  static constexpr double kReturnDelay = 0.005;  // [s] after an impact before the jack counts as returned

  bool touches(const State& state, int contact) const noexcept {
    return contact >= 0 && normal_row_[contact] >= 0 && state.impulse[normal_row_[contact]] > 0;
  }

  double hammer_rate(const State& state) const noexcept {
    double rate = 0;
    for (int j = roles_.hammer; j != kGround; j = mechanism_->model.bodies[j].parent)
      if (mechanism_->model.bodies[j].joint == JointKind::hinge) rate += state.v[j];
    return rate;
  }

  bool is_jack_under_knuckle(const State& state) const noexcept {
    if (roles_.escapement < 0) return false;
    const Contact& contact = mechanism_->model.contacts[roles_.escapement];
    const bool top_on_a = contact.shape_a.kind == ShapeKind::segment;
    if (!top_on_a && contact.shape_b.kind != ShapeKind::segment) return false;
    Frames frames;
    place_bodies(mechanism_->model, state.x, frames);
    const Vector2 none = Vector2::Zero();
    const PlacedShape a = place_shape(contact.shape_a, frames.of(contact.body_a), none);
    const PlacedShape b = place_shape(contact.shape_b, frames.of(contact.body_b), none);
    const PlacedShape& top = top_on_a ? a : b;
    const PlacedShape& knuckle = top_on_a ? b : a;
    return std::abs(top.along.dot(knuckle.centre - top.centre)) <= top.half_length;
  }

  void add(Event event, EventKind kind) noexcept {
    event.kind = kind;
    event.strike = strike_;
    if (count_ < kCapacity) event_[count_] = event;
    ++count_;
  }

  /// The next strike begins with the first sign of it after the jack returned.
  void begin_strike_if_rearmed() noexcept {
    if (!is_rearmed_) return;
    settle_escapement();
    ++strike_;
    is_rearmed_ = has_let_off_ = has_rail_ = has_impact_ = is_check_due_ = false;
    is_return_due_ = is_ready_due_ = has_left_rest_ = was_aside_ = false;
    escapement_ = next_escapement_;
    has_escaped_ = has_next_escapement_;
    has_next_escapement_ = false;
  }

  void see_descent(const Sight& now, const Event& here) noexcept {
    if (now.let_off && (!has_let_off_ || is_rearmed_)) {
      begin_strike_if_rearmed();
      has_let_off_ = is_return_due_ = is_ready_due_ = true;
      add(here, EventKind::jack_meets_let_off);
    }
    if (before_.escapement && !now.escapement) see_loss_of_contact(here);
    if (now.front_rail && (!has_rail_ || is_rearmed_)) {
      begin_strike_if_rearmed();
      has_rail_ = true;
      add(here, EventKind::key_meets_front_rail);
    }
  }

  /// Escapement is the last loss of contact before the string is hit; without impact the last one before the jack returns,
  /// or, of a press so slow that it keeps in touch until then, the last one later.
  void see_loss_of_contact(const Event& here) noexcept {
    const bool is_of_next = is_rearmed_ && (has_impact_ || is_escape_settled_);
    if (is_of_next) {
      next_escapement_ = here;
      has_next_escapement_ = true;
    } else if (!has_impact_) {
      escapement_ = here;
      has_escaped_ = true;
    }
  }

  void see_string(const Sight& now, const Event& here) noexcept {
    if (now.string && !before_.string && here.time - last_impact_ > kLockOut) {
      begin_strike_if_rearmed();
      settle_escapement(true);
      has_impact_ = is_check_due_ = is_return_due_ = is_ready_due_ = true;
      last_impact_ = here.time;
      add(here, EventKind::hammer_meets_string);
    }
    if (is_check_due_ && now.backcheck) {
      is_check_due_ = false;
      add(here, EventKind::hammer_checked);
    }
  }

  /// After an impact the return counts from 5 ms on; without one, once the jack has been aside.
  void see_return(const Sight& now, const Event& here, bool is_under) noexcept {
    if (is_return_due_ && !now.jack_rest) has_left_rest_ = true;
    if (is_return_due_ && !is_under) was_aside_ = true;
    const bool is_over = !has_impact_ || here.time >= last_impact_ + kReturnDelay;
    if (is_ready_due_ && is_over && was_aside_ && is_under) {
      is_ready_due_ = false;
      add(here, EventKind::repetition_ready);
    }
    if (is_return_due_ && is_over && was_aside_ && has_left_rest_ && now.jack_rest && !now.let_off) {
      is_return_due_ = false;
      is_rearmed_ = true;
      is_escape_settled_ = has_escaped_;
      add(here, EventKind::jack_returned);
    }
  }

  /// @param is_hit  the string is being hit; otherwise only a press that reached the let-off has escaped
  void settle_escapement(bool is_hit = false) noexcept {
    if (has_escaped_ && !has_impact_ && (has_let_off_ || is_hit)) add(escapement_, EventKind::escapement);
    has_escaped_ = is_escape_settled_ = false;
  }

  const Mechanism* mechanism_;
  ActionRoles roles_;
  double hammer_radius_ = 0;  // [m]
  std::array<int, kMaxContacts> normal_row_{};

  std::array<Event, kCapacity> event_{};
  int count_ = 0;
  int strike_ = 1;
  Sight before_;
  double hammer_speed_ = 0;                                        // at the last step [m/s]
  double last_impact_ = -std::numeric_limits<double>::infinity();  // [s]
  Event escapement_;                                               // the last candidate
  bool has_let_off_ = false, has_rail_ = false, has_impact_ = false, has_escaped_ = false;
  Event next_escapement_;  // a candidate that came after the jack had returned
  bool is_escape_settled_ = false, has_next_escapement_ = false;
  bool is_check_due_ = false, is_return_due_ = false, is_ready_due_ = false;
  bool has_left_rest_ = false, was_aside_ = false, is_rearmed_ = false;
};

}  // namespace erard

// What the running host asks of actuators: never more than they stand, never what they cannot do.
#include "support/device.hpp"
#include "support/host_test.hpp"

namespace erard {
namespace {

using test::Child;
using test::eventually;
using test::RecordedPeriod;

constexpr double kT = 5e-4;  // [s]

/// The device file with other numbers; each key stands there once.
std::string device_text(const std::vector<std::pair<std::string, double>>& changes) {
  std::string text = test::read_text(ERARD_CONFIG_DIR "/device.yaml");
  for (const auto& [key, value] : changes) {
    const std::size_t name = text.find(" " + key + ": "), begin = name + key.size() + 3;
    if (name == std::string::npos) throw std::runtime_error("no " + key + " in the device file");
    text.replace(begin, text.find_first_of(" \n", begin) - begin, std::to_string(value));
  }
  return text;
}

/// The winding by the equation of VoiceCoil, from the currents alone.
class Winding {
 public:
  explicit Winding(const VoiceCoilSettings& settings) : settings_(settings) {}

  void carry(double current, double seconds) {
    const double load = current / settings_.continuous_current;
    heat_ += seconds / settings_.thermal_time * (load * load - heat_);
    hottest_ = std::max(hottest_, heat_);
    largest_ = std::max(largest_, std::abs(current));
  }
  double hottest() const { return hottest_; }  // 1 is what it stands
  double largest() const { return largest_; }  // [A]

 private:
  VoiceCoilSettings settings_;
  double heat_ = 0, hottest_ = 0, largest_ = 0;
};

class HostCurrents : public test::HostTest {
 protected:
  /// What the renderer made of each period of the recording, and a check that the host said the same.
  std::vector<KeyOutput> repeat(const test::RecordedSession& session) {
    Renderer renderer(session.parts.action.model, session.parts.action.roles, session.rendering());
    std::vector<KeyOutput> all;
    for (const RecordedPeriod& period : session.periods) {
      std::vector<PositionMessage> messages;
      for (const positions_t& p : period.arrived) messages.push_back(position_message(p));
      all.push_back(renderer.period({period.time(), messages}).key[0]);
      EXPECT_EQ(all.back().force, period.force());
    }
    int compared = 0;
    const std::int64_t first = session.periods.at(0).forces.sequence;
    for (const actuator_commands_t& command : device_->heard().commands) {
      if (command.sequence < first) continue;
      const KeyOutput& key = all.at(static_cast<std::size_t>(command.sequence - first));
      EXPECT_EQ(command.current_A[0], key.current);
      EXPECT_EQ(command.expected_force_N[0], key.expected_force);
      ++compared;
    }
    EXPECT_GT(compared, 500);
    return all;
  }
};

TEST_F(HostCurrents, ABrakeIsNeverAskedToPush) {
  start({"--actuator", "mr"});
  device_->fall_silent();
  Child rig("erard-rig", {"--actuator", "mr", "--notes", "4", "--count", "4", "--lead", "0.3", "--table", "0"});
  const test::Outcome played = rig.wait();
  EXPECT_EQ(played.exit_code, 0) << played.error;
  const test::Outcome outcome = stop();
  expect_named(Fault::cannot_push, outcome);
  const test::RecordedSession session = test::read_session(log());
  test::expect_safe(session);
  const MrBrakeSettings& brake = session.rendering().actuator.mr_brake;
  int braking = 0, asked_to_push = 0;
  for (const KeyOutput& key : repeat(session)) {
    ASSERT_GE(key.current, 0);
    ASSERT_LE(key.current, brake.max_current);
    braking += key.current > 0 ? 1 : 0;
    if (std::abs(key.piston.rate) <= brake.standstill_speed) continue;  // it holds, either way
    ASSERT_GE(key.expected_force * key.piston.rate, 0);                 // takes energy, never gives it
    if (key.force * key.piston.rate >= 0) continue;
    ASSERT_EQ(key.current, 0);
    ++asked_to_push;
  }
  EXPECT_GT(braking, 100);
  EXPECT_GT(asked_to_push, 20);  // on the way up
  for (const actuator_commands_t& command : device_->heard().commands)
    ASSERT_EQ(command.actuator, actuator_commands_t::kMrBrake);
}

TEST_F(HostCurrents, AVoiceCoilNeverOverheatsUnderFortissimo) {
  // a winding that warms in half a second and stands a quarter of the config's current: a minute becomes a second
  const std::string device = folder_ / "device.yaml";
  test::write_text(device, device_text({{"continuous_current_A", 0.25}, {"thermal_time_s", 0.5}}));
  start({"--device", device});
  device_->play(test::rest(0.1));
  for (int i = 0; i < 12; ++i) {
    device_->play(stroke_.press);
    device_->play(stroke_.release);
  }
  ASSERT_TRUE(eventually([&] { return device_->is_still(); }));
  const test::Outcome outcome = stop();
  expect_named(Fault::thermal_limited, outcome);
  const test::RecordedSession session = test::read_session(log());
  test::expect_safe(session);
  const VoiceCoilSettings& coil = session.rendering().actuator.voice_coil;
  Winding winding(coil);
  for (const KeyOutput& key : repeat(session)) {
    ASSERT_LE(std::abs(key.expected_force), std::abs(key.force) + 1e-12);
    winding.carry(key.current, session.rendering().tick.period);
  }
  EXPECT_LE(winding.largest(), coil.max_current);
  EXPECT_LE(winding.hottest(), 1);
  EXPECT_GT(winding.hottest(), 0.8);  // or the limit had nothing to do
}

/// A minute without a clock: forte strokes one after the other, the lever pressed a quarter deeper.
class MinuteOfFortissimo : public testing::Test {
 protected:
  void play(const std::vector<std::pair<std::string, double>>& changes) {
    settings_ = load_device(ConfigText{"device.yaml", device_text(changes)}).rendering;
    const ActionFile action = test::grand_action();
    test::Device device(action, settings_);
    const test::PressAndRelease stroke = test::forte();
    std::vector<double> once = stroke.press;
    once.insert(once.end(), stroke.release.begin(), stroke.release.end());
    winding_ = std::make_unique<Winding>(settings_.actuator.voice_coil);
    double before = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(60 / kT); ++i) {
      const KeyOutput& key = device.play(1.25 * once[i % once.size()]);
      ASSERT_LE(std::abs(key.force), settings_.guard.max_force);
      ASSERT_LE(std::abs(key.force - before), settings_.guard.max_slew * kT + 1e-12);
      before = key.force;
      largest_ = std::max(largest_, key.force);
      winding_->carry(key.current, kT);
    }
    counters_ = device.renderer.counters();
    EXPECT_LE(winding_->largest(), settings_.actuator.voice_coil.max_current);
    EXPECT_LE(winding_->hottest(), 1);
    EXPECT_GT(largest_, 12);  // fortissimo it was
  }

  RenderSettings settings_;
  std::unique_ptr<Winding> winding_;
  FaultCounters counters_;
  double largest_ = 0;
};

TEST_F(MinuteOfFortissimo, IsNotHeldBackByTheCoilOfTheDeviceFile) {
  play({});
  EXPECT_EQ(counters_[Fault::thermal_limited], 0);
  EXPECT_EQ(counters_[Fault::current_limited], 0);
  EXPECT_GT(winding_->hottest(), 0.05);
}

TEST_F(MinuteOfFortissimo, FoldsBackACoilThatCannotStandIt) {
  play({{"continuous_current_A", 0.25}});
  EXPECT_GT(counters_[Fault::thermal_limited], 1000);
  EXPECT_GT(winding_->hottest(), 0.8);
}

}  // namespace
}  // namespace erard

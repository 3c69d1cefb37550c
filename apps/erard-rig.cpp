// erard-rig: a virtual device. Lever, sensor, actuator and finger on LCM, in the place of the hardware.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "erard/device/config_dir.hpp"
#include "erard/device/intended_motion.hpp"
#include "erard/device/output_file.hpp"
#include "erard/device/real_time.hpp"
#include "erard/device/rig_link.hpp"
#include "erard/device/session.hpp"
#include "program.hpp"

namespace {

using namespace erard;

std::atomic<bool> is_interrupted{false};

struct Options {
  std::string keystroke, device, actuator, csv;
  std::optional<double> notes_Hz, hold_s, dead_time_us, time_constant_us, duration;
  double lead_s = 1, depth_mm = 10, travel_ms = 40, rate_Hz = 2000, table_s = 0.1;
  int count = 10, keys = 1, priority = 75;
  double mass_g = 100, dry_N = 0.05, viscous = 0.1;
  double travel_mm = 15;  // 20 N through the coupling of 4000 N/m are 5 mm below the key bottom
  double noise_um = 50, resolution_um = 0, sensor_delay_us = 0;
  std::uint64_t seed = 1;
  double finger_stiffness = 1000, finger_damping = 5;
  bool is_rigid = false;
};

void add_options(CLI::App& app, Options& o) {
  const auto range = number_from;
  app.add_option("KEYSTROKE", o.keystroke,
                 "what the finger means to do, CSV with t_s and position_m (default: config/keystrokes/forte.csv)");
  app.add_option("--notes", o.notes_Hz, "repeated notes instead, so many a second")->check(range(0.1, 30));
  app.add_option("--count", o.count, "of the notes")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--hold", o.hold_s, "a press that is held for so many seconds instead")->check(range(0.01, 1e5));
  app.add_option("--depth", o.depth_mm, "of notes and presses in mm")->check(range(0.1, 30))->capture_default_str();
  app.add_option("--travel", o.travel_ms, "time of their way down, and up, in ms")
      ->check(range(1, 10000))
      ->capture_default_str();
  app.add_option("--lead", o.lead_s, "seconds before the finger moves")->check(range(0, 3600))->capture_default_str();
  app.add_option("--duration", o.duration, "end after so many seconds (default: half a second after the motion)")
      ->check(range(0.001, 1e6));
  app.add_option("--lever-mass", o.mass_g, "at the finger, in g")->check(range(1, 5000))->capture_default_str();
  app.add_option("--lever-friction", o.dry_N, "dry, in N")->check(range(0, 20))->capture_default_str();
  app.add_option("--lever-viscous", o.viscous, "in N s/m")->check(range(0, 100))->capture_default_str();
  app.add_option("--lever-depth", o.travel_mm, "way to its lower stop in mm")
      ->check(range(1, 100))
      ->capture_default_str();
  app.add_option("--sensor-noise", o.noise_um, "rms, in um")->check(range(0, 5000))->capture_default_str();
  app.add_option("--sensor-resolution", o.resolution_um, "of one count in um, 0: none")
      ->check(range(0, 5000))
      ->capture_default_str();
  app.add_option("--sensor-delay", o.sensor_delay_us, "in us")->check(range(0, 20000))->capture_default_str();
  app.add_option("--seed", o.seed, "of the noise")->capture_default_str();
  app.add_option("--finger-stiffness", o.finger_stiffness, "in N/m")->check(range(1, 1e6))->capture_default_str();
  app.add_option("--finger-damping", o.finger_damping, "in N s/m")->check(range(0, 1000))->capture_default_str();
  app.add_flag("--rigid", o.is_rigid, "a rigid stop of 5e4 N/m instead of a finger");
  app.add_option("--device", o.device, "addresses, channels and actuator (default: config/device.yaml)");
  app.add_option("--actuator", o.actuator,
                 "voice-coil, mr, or none: forces as they are (default: that of the device file)");
  app.add_option("--actuator-lag", o.time_constant_us,
                 "time constant of the actuator in us (default: 300 for a voice coil, 3000 for MR)")
      ->check(range(0, 1e5));
  app.add_option("--actuator-dead-time", o.dead_time_us, "in us (default: 0 for a voice coil, 500 for MR)")
      ->check(range(0, 1e5));
  app.add_option("--keys", o.keys, "levers with a finger each, all meaning the same")
      ->check(CLI::Range(1, 88))
      ->capture_default_str();
  app.add_option("--rate", o.rate_Hz, "samples a second")->check(range(100, 50000))->capture_default_str();
  app.add_option("--priority", o.priority, "SCHED_FIFO, 0: ordinary scheduling; what is refused is told")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_option("--table", o.table_s, "print a line every so many seconds, 0: none")
      ->check(range(0, 3600))
      ->capture_default_str();
  app.add_option("--csv", o.csv, "write every period of the first key to this file (default: none)");
}

/// A finger that waits for `lead` seconds first.
Keystroke after(const Keystroke& motion, double lead) {
  constexpr double kQuiet = 1e-3;  // [s] two samples so close before the motion keep the spline from swinging before it
  if (lead < 3 * kQuiet) return motion;
  std::vector<double> times{0, lead - 2 * kQuiet, lead - kQuiet}, values(3, motion.values().front());
  for (const double time : motion.times()) times.push_back(lead + time - motion.start());
  values.insert(values.end(), motion.values().begin(), motion.values().end());
  return {motion.quantity(), std::move(times), std::move(values)};
}

Keystroke motion(const Options& o) {
  if (o.notes_Hz && o.hold_s) throw InputError("--notes and --hold: one of them, not both");
  if (!o.keystroke.empty() && (o.notes_Hz || o.hold_s))
    throw InputError(fmt::format("{}: a keystroke goes without --notes and --hold", o.keystroke));
  const double depth = 1e-3 * o.depth_mm, travel = 1e-3 * o.travel_ms;
  const auto build = [&]() -> Keystroke {
    if (o.hold_s) return press_and_hold(depth, 0.001, travel, *o.hold_s);
    if (o.notes_Hz) return repeated_notes(depth, *o.notes_Hz, o.count, travel, 0.5 / *o.notes_Hz - travel);
    return read_keystroke(o.keystroke.empty() ? (config_dir() / "keystrokes" / "forte.csv").string() : o.keystroke);
  };
  try {
    return after(build(), o.lead_s);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("the motion cannot be: {}", error.what()));
  }
}

RigLinkSettings settings_of(const Options& o) {
  Session session;
  session.device =
      read_config(o.device.empty() ? config_dir() / "device.yaml" : std::filesystem::path(o.device), "a device file");
  if (!o.actuator.empty()) session.overrides.actuator = o.actuator;
  const DeviceSettings device = load_device(session);
  RigLinkSettings s;
  s.keys = o.keys;
  s.period = 1 / o.rate_Hz;
  s.link = device.link;
  s.actuator = device.rendering.actuator;
  const bool is_brake = s.actuator.kind == ActuatorKind::mr_brake;
  s.rig.actuator = is_brake ? VirtualActuatorSettings::mr_brake() : VirtualActuatorSettings::voice_coil();
  if (is_brake) s.rig.actuator.off_drag = s.actuator.mr_brake.drag;
  if (o.time_constant_us) s.rig.actuator.time_constant = 1e-6 * *o.time_constant_us;
  if (o.dead_time_us) s.rig.actuator.dead_time = 1e-6 * *o.dead_time_us;
  s.rig.lever.mass = 1e-3 * o.mass_g;
  s.rig.lever.dry_friction = o.dry_N;
  s.rig.lever.viscous = o.viscous;
  s.rig.lever.depth = 1e-3 * o.travel_mm;
  s.rig.sensor = {1e-6 * o.resolution_um, 1e-6 * o.noise_um, 1e-6 * o.sensor_delay_us, o.seed};
  s.rig.finger = o.is_rigid ? kRigidStop : FingerSettings{o.finger_stiffness, o.finger_damping};
  return s;
}

/// What the loop leaves behind for --csv; its memory is taken before the loop.
struct Trace {
  std::vector<RigView> rows;
  void keep(const RigView& view) noexcept {
    if (rows.size() < rows.capacity()) rows.push_back(view);
  }
};

void write_trace(const Trace& trace, OutputFile& file) {
  std::string text = "t_s,intended_m,lever_m,finger_N,command_N,latency_s,valid\n";
  for (const RigView& v : trace.rows)
    text += fmt::format("{},{},{},{},{},{},{}\n", v.time, v.intended, v.lever, v.finger_force, v.command, v.latency,
                        v.is_valid ? 1 : 0);
  file.write(text);
  file.commit();
}

void print_line(const RigView& v) {
  fmt::print("{:7.2f} s  key {:6.2f} mm  finger {:6.2f} N  command {:6.2f} N  latency {:5.0f} us  {}\n", v.time,
             1e3 * v.lever, v.finger_force, v.command, 1e6 * v.latency,
             !v.is_valid     ? "no valid command"
             : v.faulted > 0 ? "host fades"
             : v.blows > 0   ? fmt::format("hammer {:.2f} m/s ({} blows)", v.blow_speed, v.blows)
                             : "");
  std::fflush(stdout);
}

int run(const Options& o) {
  const Keystroke intended = motion(o);
  const RigLinkSettings settings = settings_of(o);
  const double duration = o.duration.value_or(intended.end() + 0.5);
  std::optional<OutputFile> csv;
  if (!o.csv.empty()) csv.emplace(o.csv);
  Trace trace;
  if (csv) trace.rows.reserve(static_cast<std::size_t>(duration * o.rate_Hz) + 1000);

  RigLink link(settings, intended);
  link.watch([](void* context, const RigView& view) noexcept { static_cast<Trace*>(context)->keep(view); }, &trace);
  PeriodicLoop<> loop({std::llround(1e9 * settings.period)});
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  LoopSummary summary;
  std::thread device([&] {
    if (o.priority > 0) {
      const Grant grant = request_fifo(o.priority);
      if (!grant.is_granted)
        fmt::print(stderr, "erard-rig: {} refused, carrying on without: {}\n", grant.asked, grant.remedy);
    }
    summary = loop.run(link);
  });
  using Clock = std::chrono::steady_clock;
  constexpr double kLook = 0.02;  // [s]
  const double pause = o.table_s > 0 ? o.table_s : kLook;
  Clock::time_point next = Clock::now();
  while (!is_interrupted && link.view().time < duration) {
    next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
    std::this_thread::sleep_until(next);
    if (o.table_s > 0) print_line(link.view());
  }
  loop.stop();
  device.join();
  const RigView last = link.view();
  fmt::print("periods      {}, {} missed; {} commands, {} blows\n", summary.status.periods, summary.status.missed,
             last.answers, last.blows);
  if (csv) write_trace(trace, *csv);
  if (std::fflush(stdout) != 0) throw std::runtime_error("the report could not be written to the standard output");
  return is_interrupted ? kInterrupted : last.answers > 0 ? kDone : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Plays the device that erard-device renders to: a lever with sensor, actuator and a finger on it, over LCM.",
      "erard-rig");
  app.footer("Exit codes: 0 done, 1 the run failed or no command ever came, 2 bad input, 130 interrupted.");
  Options options;
  add_options(app, options);
  return run_program(app, argc, argv, [&] { return run(options); });
}

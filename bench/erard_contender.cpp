#include "bench/keyboard.hpp"

namespace erard::bench {
namespace {

TickSettings settings_of(const Job& job) {
  TickSettings settings;
  settings.drive = DriveKind::piston;
  settings.set_rate(job.rate_Hz, job.is_split ? 0 : job.substeps);
  return settings;
}

class ErardContender : public Contender {
 public:
  ErardContender(const Stage& stage, const Job& job)
      : keyboard_(stage.mechanism, settings_of(job), cast(*job.scene, stage, job.keys)) {}
  void start() override { keyboard_.start(); }
  Effort tick(StepClock steps) override { return keyboard_.tick(steps); }
  double force() const override { return keyboard_.force(); }

 private:
  Keyboard keyboard_;
};

}  // namespace

std::unique_ptr<Contender> make_erard(const Stage& stage, const Job& job) {
  return std::make_unique<ErardContender>(stage, job);
}

}  // namespace erard::bench

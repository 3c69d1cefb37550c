// MuJoCo on the same topology, played the same way. How it is made as fast and as exact as it can be: action.xml.
#include <mujoco/mujoco.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/contender.hpp"

namespace erard {
std::string_view peer_file(std::string_view name);  // written by CMake

namespace bench {
namespace {

constexpr double kSettling = 0.3;  // [s] from the initial angles to rest

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using ModelHolder = std::unique_ptr<mjModel, ModelDeleter>;
using DataHolder = std::unique_ptr<mjData, DataDeleter>;
using SpecHolder = std::unique_ptr<mjSpec, SpecDeleter>;

void take_out(mjSpec* spec, mjtObj kind, const char* name) {
  if (mjs_delete(spec, mjs_findElement(spec, kind, name)) != 0)
    throw std::runtime_error(fmt::format("MuJoCo: {} cannot be taken out of action.xml", name));
}

/// Springs and dampers of the slides as implicit Euler takes them, in the mass matrix, where the contact solver sees
/// them:  (m + h b + h^2 k) dv = -h (k x + (b + h k) v). The joints' own implicit damping is switched off.
/// Contacts and dry hinges: the stiffest that a step resolves, a time constant of two steps.
/// Before the model is compiled: the compiler derives the scale of each constraint from the inertia that it moves, which
/// for felts of 15 mg without armature makes contacts a hundred times too soft.
void make_implicit(mjSpec* spec, double h) {
  spec->option.timestep = h;
  for (auto* e = mjs_firstElement(spec, mjOBJ_JOINT); e != nullptr; e = mjs_nextElement(spec, e)) {
    mjsJoint& joint = *mjs_asJoint(e);
    joint.solref_friction[0] = 2 * h;
    if (joint.type != mjJNT_SLIDE) continue;
    const double k = joint.stiffness[0], b = joint.damping[0];
    joint.armature = h * b + h * h * k;
    joint.damping[0] = b + h * k;
  }
  for (auto* e = mjs_firstElement(spec, mjOBJ_PAIR); e != nullptr; e = mjs_nextElement(spec, e))
    mjs_asPair(e)->solref[0] = 2 * h;
}

ModelHolder load(bool with_damper, double h) {
  std::array<char, 1000> error{};
  const SpecHolder spec(
      mj_parseXMLString(std::string(peer_file("action.xml")).c_str(), nullptr, error.data(), error.size()));
  if (!spec) throw std::runtime_error(fmt::format("MuJoCo cannot read action.xml: {}", error.data()));
  if (!with_damper) {
    for (const char* pair : {"KD", "DG"}) take_out(spec.get(), mjOBJ_PAIR, pair);
    for (const char* body : {"felt_KD", "felt_DG", "D"}) take_out(spec.get(), mjOBJ_BODY, body);
  }
  make_implicit(spec.get(), h);
  ModelHolder model(mj_compile(spec.get(), nullptr));
  if (!model) throw std::runtime_error(fmt::format("MuJoCo refuses action.xml: {}", mjs_getError(spec.get())));
  return model;
}

class MujocoKeyboard : public Contender {
 public:
  MujocoKeyboard(const Stage& stage, const Job& job)
      : model_(load(stage.has_damper, 1 / (job.rate_Hz * job.substeps))),
        finger_(stage.mechanism().model.finger),
        substeps_(job.substeps),
        parts_(cast(*job.scene, stage, job.keys)),
        pistons_(parts_.size() * static_cast<std::size_t>(substeps_)) {
    DataHolder rest(mj_makeData(model_.get()));
    key_ = mj_name2id(model_.get(), mjOBJ_JOINT, "K");
    dof_ = model_->jnt_dofadr[key_];
    key_armature_ = model_->dof_armature[dof_];
    settle(stage, *rest);
    for (std::size_t k = 0; k < parts_.size(); ++k) keys_.emplace_back(mj_copyData(nullptr, model_.get(), rest.get()));
    const long play_in = job.scene->is_keyboard ? std::lround(duration_of(*job.scene, stage) * job.rate_Hz) : 0;
    for (; ticks_ < play_in;) {
      MujocoKeyboard::prepare();
      MujocoKeyboard::tick({});
    }
    for (const DataHolder& each : keys_) start_.emplace_back(mj_copyData(nullptr, model_.get(), each.get()));
    start_ticks_ = ticks_;
  }

  void start() override {
    for (std::size_t k = 0; k < keys_.size(); ++k) mj_copyData(keys_[k].get(), model_.get(), start_[k].get());
    ticks_ = start_ticks_;
  }

  void prepare() override {
    const double h = model_->opt.timestep;
    std::size_t next = 0;
    for (const Part& part : parts_)
      for (int i = 1; i <= substeps_; ++i) pistons_[next++] = part.at(static_cast<double>(ticks_ * substeps_ + i) * h);
  }

  void tick(StepClock steps) override {
    effort_ = {};
    const DriveSample* piston = pistons_.data();
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      mjData& data = *keys_[k];
      for (int i = 0; i < substeps_; ++i, ++piston) {
        step(data, *piston);
        steps.mark();
        ++effort_.steps;
        effort_.iterations += data.solver_niter[0];
        effort_.not_converged += data.solver_niter[0] >= model_->opt.iterations;
      }
      if (k == 0) force_ = force_at(data, piston[-1]);
      effort_.is_finite = effort_.is_finite && std::isfinite(data.qpos[model_->jnt_qposadr[key_]]);
    }
    ++ticks_;
  }

  Effort effort() const override { return effort_; }
  double force() const override { return force_; }

 private:
  double position(const mjData& data) const {
    return -finger_.arm * (data.qpos[model_->jnt_qposadr[key_]] - rest_angle_);
  }
  double velocity(const mjData& data) const { return -finger_.arm * data.qvel[dof_]; }
  double force_at(const mjData& data, const DriveSample& piston) const {
    return std::max(
        0.0, finger_.stiffness * (piston.value - position(data)) + finger_.damping * (piston.rate - velocity(data)));
  }

  /// The piston's Kelvin-Voigt element is an explicit force with its implicit part in the key's armature, as the felts:
  ///   F = F0 - (b + h a) (y'+ - y'),  F0 = a (Y+ - y - h y') + b (Y'+ - y')
  /// It does not pull: no force and no armature when F0 < 0.
  void step(mjData& data, const DriveSample& piston) {
    const double h = model_->opt.timestep;
    const double y = position(data), rate = velocity(data);
    const double force = finger_.stiffness * (piston.value - y - h * rate) + finger_.damping * (piston.rate - rate);
    const bool presses = force > 0;
    const double inertia = h * (finger_.damping + h * finger_.stiffness) * finger_.arm * finger_.arm;
    model_->dof_armature[dof_] = key_armature_ + (presses ? inertia : 0.0);
    data.qfrc_applied[dof_] = presses ? -finger_.arm * force : 0.0;
    mj_step(model_.get(), &data);
  }

  void settle(const Stage& stage, mjData& data) {
    const Model& action = stage.mechanism().model;
    for (int i = 0; i < action.body_count; ++i) {
      const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, std::string(action.bodies[i].name.view()).c_str());
      if (joint >= 0) data.qpos[model_->jnt_qposadr[joint]] = action.bodies[i].initial;
    }
    const long steps = std::lround(kSettling / model_->opt.timestep);
    for (long i = 0; i < steps; ++i) mj_step(model_.get(), &data);
    rest_angle_ = data.qpos[model_->jnt_qposadr[key_]];
  }

  ModelHolder model_;  // one for all keys; the armature of the key changes with the key that is stepped
  Finger finger_;
  int substeps_;
  std::vector<Part> parts_;
  std::vector<DriveSample> pistons_;  // of the next period: substeps of each key
  std::vector<DataHolder> start_, keys_;
  int key_ = 0, dof_ = 0;
  double key_armature_ = 0;  // [kg m^2]
  double rest_angle_ = 0;    // [rad]
  long ticks_ = 0, start_ticks_ = 0;
  Effort effort_;     // of the last period
  double force_ = 0;  // of the first key [N]
};

}  // namespace

std::string mujoco_version() { return fmt::format("MuJoCo {}", mj_versionString()); }

std::unique_ptr<Contender> make_mujoco(const Stage& stage, const Job& job) {
  return std::make_unique<MujocoKeyboard>(stage, job);
}

}  // namespace bench
}  // namespace erard

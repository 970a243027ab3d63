// SPDX-License-Identifier: MIT
#include "fake_baxter/mujoco_arm.hpp"

#include "baxter/kinematics.hpp"
#include "fake_baxter/links.hpp"
#include "fake_baxter/series_elastic.hpp"

#include <mujoco/mujoco.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace palpate::fake_baxter {
namespace {

using namespace baxter::geometry;

constexpr double kGravity = 9.81;  // m/s^2
constexpr double kStep = 2e-4;     // s: MuJoCo's contacts are best if they may be harder than the objects
constexpr int kInPeriod = 50;      // steps
constexpr int kTogether = 5;       // steps that are combined if nothing is near the tip
constexpr double kNear = 0.005;    // m of the tip above the scene, more than it moves in a period
// kg, mass of the plate under the tip, small enough for its spring to determine the force
constexpr double kPlate = 0.02;
constexpr double kClear = 0.002;   // m of the tip above the scene, more than it bounces
constexpr double kRadius = 0.004;  // m, of the tip

std::string frame(const JointTransform& step) {
  return fmt::format("pos='{} {} {}' euler='{} {} {}'", step.x, step.y, step.z, step.roll, step.pitch, step.yaw);
}

std::string body(const Link& link) {
  const double* i = link.inertia;
  return fmt::format("<inertial pos='{} {} {}' mass='{}' fullinertia='{} {} {} {} {} {}'/>", link.centre[0],
                     link.centre[1], link.centre[2], link.mass, i[0], i[1], i[2], i[3], i[4], i[5]);
}

std::string joint(std::size_t number, double friction) {
  const double damping = kBearings + spring_damping()(static_cast<Eigen::Index>(number));
  return fmt::format("<joint name='{}' damping='{}' frictionloss='{}'/>", baxter::kJointNames[number], damping,
                     friction);
}

}  // namespace

std::string mujoco_model(const Eigen::Vector3d& tip, double stiffness, double friction) {
  // tapping::HeightResult and friction are as stiff as the step allows. So only the plate's spring yields, and a
  // sticking joint stays in place.
  std::string out = fmt::format(R"(<mujoco>
<compiler angle='radian' eulerseq='XYZ' inertiafromgeom='false'/>
<option timestep='{step}' integrator='implicit' gravity='0 0 -{gravity}'/>
<default>
  <joint type='hinge' axis='0 0 1' solreffriction='{hard} 1' solimpfriction='{limits}'/>
  <geom condim='1' solref='{hard} 1' solimp='{limits}'/>
</default>
<worldbody>
<body name='plate'>
  <joint name='plate' type='slide' stiffness='{stiffness}' damping='{damping}'/>
  <inertial pos='0 0 0' mass='{plate}' diaginertia='0.001 0.001 0.001'/>
  <geom name='plate' type='box' size='2 2 0.1' pos='0 0 -0.1'/>
</body>
<body name='mount' {mount}>
)",
                                fmt::arg("step", kStep), fmt::arg("gravity", kGravity), fmt::arg("hard", 2 * kStep),
                                fmt::arg("limits", "0.99 0.999 0.0001"), fmt::arg("stiffness", stiffness),
                                fmt::arg("damping", kRelaxation * stiffness), fmt::arg("plate", kPlate),
                                fmt::arg("mount", frame(kMount)));
  for (std::size_t i = 0; i < kLinks.size(); ++i) {
    out +=
        fmt::format("<body name='{}' {}>{}{}", kLinks[i].name, frame(kSteps[i]), joint(i, friction), body(kLinks[i]));
  }
  // The lowest point of the tip's sphere is the tip.
  out += fmt::format(
      "<body name='hand' pos='0 0 {}'>{}<body name='tool'>{}<site name='tip' pos='{} {} {}'/>"
      "<geom name='tip' type='sphere' size='{}' pos='{} {} {}'/></body></body>",
      kHand, body(kHandLink), body(tool_link(tip)), tip.x(), tip.y(), tip.z(), kRadius, tip.x(), tip.y(),
      tip.z() - kRadius);
  for (std::size_t i = 0; i < kLinks.size(); ++i) out += "</body>";
  return out + "</body></worldbody></mujoco>";
}

namespace {

struct Free {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

/// Loads a model. MuJoCo reads models only from files, which may be virtual files in memory.
std::unique_ptr<mjModel, Free> load(const std::string& text) {
  constexpr const char* kName = "arm.xml";
  mjVFS files;
  mj_defaultVFS(&files);
  if (mj_makeEmptyFileVFS(&files, kName, static_cast<int>(text.size())) != 0)
    throw std::runtime_error("MuJoCo: no memory");
  std::copy(text.begin(), text.end(), static_cast<char*>(files.filedata[mj_findFileVFS(&files, kName)]));
  char trouble[500] = "";
  std::unique_ptr<mjModel, Free> out(mj_loadXML(kName, &files, trouble, sizeof trouble));
  mj_deleteVFS(&files);
  if (!out) throw std::runtime_error(std::string("MuJoCo: ") + trouble);
  return out;
}

class MujocoArm final : public Mechanics {
 public:
  MujocoArm(const SceneFrame& scene_frame, const Eigen::Vector3d& tip, double friction)
      : scene_frame_(scene_frame),
        motors_(joint_lag(scene_frame.scene()), kStep),
        model_(load(mujoco_model(tip, object_stiffness(scene_frame.scene()), friction))),
        data_(mj_makeData(model_.get())),
        tip_(mj_name2id(model_.get(), mjOBJ_SITE, "tip")) {}

  void put(const Joints& joints) override {
    mj_resetData(model_.get(), data_.get());
    state_ = {};
    Eigen::Map<Joints>(data_->qpos + kArm) = joints;
    data_->qpos[0] = surface();
    motors_.put(joints + (kSag * weight(joints)).cwiseQuotient(spring_stiffness()));
    measure();
  }

  void advance(const Joints& reference) override {
    state_.peak = 0.0;
    state_.depth = 0.0;
    const bool near = data_->ncon > 0 || data_->site_xpos[3 * tip_ + 2] < surface() + kNear;
    const int together = near ? 1 : kTogether;
    model_->opt.timestep = together * kStep;
    for (int i = 0; i < kInPeriod; i += together) step(reference, together);
    measure();
  }

  Joints holding() const override { return motors_.position(); }
  void brake() override { motors_.put(motors_.position()); }

 private:
  static constexpr int kArm = 1;  ///< the plate is the first degree of freedom

  Eigen::Map<Joints> position() const { return Eigen::Map<Joints>(data_->qpos + kArm); }
  Eigen::Map<Joints> speed() const { return Eigen::Map<Joints>(data_->qvel + kArm); }

  /// Returns the height of the scene below the tip, in `base`, m.
  double surface() {
    mj_kinematics(model_.get(), data_.get());
    const Eigen::Vector3d tip = Eigen::Map<const Eigen::Vector3d>(data_->site_xpos + 3 * tip_);
    return tip.z() - scene_frame_.clearance(tip);
  }

  /// Returns the torques of gravity by MuJoCo's inverse dynamics.
  Joints weight(const Joints& joints) {
    mjData* still = rest();
    Eigen::Map<Joints>(still->qpos + kArm) = joints;
    mj_kinematics(model_.get(), still);
    mj_comPos(model_.get(), still);
    mj_comVel(model_.get(), still);
    Eigen::Matrix<mjtNum, 8, 1> out;
    mj_rne(model_.get(), still, 0, out.data());
    return out.tail<7>();
  }

  mjData* rest() {
    if (!rest_) rest_.reset(mj_makeData(model_.get()));
    return rest_.get();
  }

  void step(const Joints& reference, int together) {
    for (int i = 0; i < together; ++i) motors_.follow(reference);
    const Joints carried = weight(position());
    state_.effort = motors_.torque(position(), speed(), carried);
    // MuJoCo integrates the damping of the joints' own speed implicitly, so it is removed here.
    Eigen::Map<Joints>(data_->qfrc_applied + kArm) = state_.effort + spring_damping().cwiseProduct(Joints(speed()));
    model_->qpos_spring[0] = surface();
    // The scene is at rest. Without this reset the plate would oscillate when the tip passes an edge.
    if (data_->site_xpos[3 * tip_ + 2] > model_->qpos_spring[0] + kClear) {
      data_->qpos[0] = model_->qpos_spring[0];
      data_->qvel[0] = 0.0;
    }
    data_->qfrc_applied[0] = kGravity * kPlate;
    mj_step(model_.get(), data_.get());
    press();
  }

  void press() {
    state_.pressing = 0.0;
    for (int i = 0; i < data_->ncon; ++i) {
      mjtNum force[6];
      mj_contactForce(model_.get(), data_.get(), i, force);
      state_.pressing += force[0];
    }
    state_.peak = std::max(state_.peak, state_.pressing);
    if (data_->ncon > 0) state_.depth = std::max(state_.depth, model_->qpos_spring[0] - data_->qpos[0]);
  }

  void measure() {
    state_.position = position();
    state_.velocity = speed();
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    std::vector<mjtNum> rows(static_cast<std::size_t>(6 * model_->nv));
    mj_jacSite(model_.get(), data_.get(), rows.data(), rows.data() + 3 * model_->nv, tip_);
    const Eigen::Map<const Eigen::Matrix<mjtNum, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> all(rows.data(), 6,
                                                                                                       model_->nv);
    state_.felt = estimate_force(all.rightCols<7>(), weight(position()) - state_.effort);
  }

  SceneFrame scene_frame_;
  Motors motors_;
  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
  std::unique_ptr<mjData, Free> rest_;  ///< second state of the arm, for weight()
  int tip_;
};

}  // namespace

bool has_mujoco() { return true; }

std::unique_ptr<Mechanics> make_mujoco(const SceneFrame& scene_frame, const Eigen::Vector3d& tip, double friction) {
  return std::make_unique<MujocoArm>(scene_frame, tip, friction);
}

}  // namespace palpate::fake_baxter

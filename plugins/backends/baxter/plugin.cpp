// SPDX-License-Identifier: MIT
// The backend `baxter`: taps with the left arm of a Baxter.
#include "baxter/options.hpp"
#include "baxter/real_time.hpp"
#include "baxter/ros/connect.hpp"
#include "baxter/tapper.hpp"
#include "children/arm_lock.hpp"

#include <palpate/belief.hpp>
#include <palpate/plugin.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

namespace palpate::baxter {
namespace {

/// Log of the driver in the folder of the run's record: file `baxter.txt`, one line per event.
class RunLog {
 public:
  /// An empty `directory` disables the log. The folder exists from the first tap on.
  explicit RunLog(std::string directory) : directory_(std::move(directory)) {}

  void note(const std::string& line) { waiting_ += line + '\n'; }

  /// Appends the lines since the last call to the file.
  void write() {
    const std::string file = directory_ + "/baxter.txt";
    // A record from another person may have a symbolic link here that leads to a file of this user.
    if (!directory_.empty() && !std::filesystem::is_symlink(file)) std::ofstream(file, std::ios::app) << waiting_;
    waiting_.clear();
  }

  /// Returns a file name for the rosbag that no earlier attempt of this run used. Adds a line to the log if an earlier
  /// bag exists.
  std::string new_bag() {
    std::string file = directory_ + "/baxter.bag";
    for (int part = 2; std::filesystem::exists(std::filesystem::symlink_status(file)); ++part) {
      if (part == 2)
        note(
            "an earlier attempt of this run has a rosbag: if the attempt was killed, repair the file with 'rosbag "
            "reindex'");
      file = directory_ + "/baxter-" + std::to_string(part) + ".bag";
    }
    return file;
  }

  bool kept() const { return !directory_.empty(); }

 private:
  std::string directory_;
  std::string waiting_;
};

/// Returns the lock of the left arm at ROS_MASTER_URI. Without this variable it takes no lock, and connect() throws
/// later.
ArmLock lock_of_arm() {
  const char* master = std::getenv("ROS_MASTER_URI");
  if (master == nullptr || *master == '\0') return {};
  const std::string uri = master;
  return {"ROS_MASTER_URI=" + uri, "left of " + uri};
}

}  // namespace

class Baxter final : public Backend {
 public:
  using Options = BaxterOptions;

  static constexpr bool kOneAtATime = true;

  /// Joins the robot's network and makes all checks that need no motion. Throws Error.
  Baxter(const Options& options, const Context& context)
      : options_(options),
        scene_(context.scene),
        log_(context.directory),
        arm_(options.dry_run ? ArmLock() : lock_of_arm()),
        robot_(connect({!options.dry_run, options.inverse_kinematics == Options::InverseKinematics::robot})),
        tapper_(options, context.scene, *robot_, context.interrupted,
                [this](const std::string& line) { log_.note(line); }) {
    tapper_.check();
    if (options.view) view_ = make_view(*robot_, options.scene_pose, scene_.area(), scene_.desk());
  }

  TapResult tap(const TapRequest& request) override {
    if (options_.bag && !begun_ && log_.kept()) robot_->record(log_.new_bag());
    if (view_) view_->target(request.line.target());
    const RealTime real_time(!robot_->read().simulated);
    if (!begun_ && !real_time.status().empty()) log_.note(real_time.status());
    begun_ = true;
    const tapping::HeightResult result = tapper_.tap(request);
    log_.write();
    return tapping::result_on(request.line, result);
  }

  std::vector<std::string> describe(const TapRequest& request) override { return tapper_.describe(request); }

  QuantitySet reads() const override {
    return view_ ? QuantitySet{quantity::kHeightMean, quantity::kHeightStd} : QuantitySet();
  }
  void show(const BeliefView& belief) override {
    if (!view_) return;
    view_->contacts(belief.taps().readings);
    view_->surface(belief.candidates().starts.leftCols<2>(), belief.values(quantity::kHeightMean),
                   belief.values(quantity::kHeightStd));
  }

  std::vector<Learnt> learnt() const override {
    const std::string sign = tapper_.learnt_sign();
    return sign.empty() ? std::vector<Learnt>() : std::vector<Learnt>{{"force_sign", sign}};
  }

  /// A dry run moves nothing, so its taps can be repeated.
  bool repeatable() const override { return options_.dry_run; }
  bool scene_is_truth() const override { return false; }
  QuantitySet predicts() const override { return tapping::predicts(options_.motion); }
  static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene) {
    return tapping::motions(options.motion, scene.desk());
  }

 private:
  Options options_;
  const Scene& scene_;
  RunLog log_;
  ArmLock arm_;  ///< held while connected
  std::unique_ptr<Robot> robot_;
  Tapper tapper_;
  std::unique_ptr<SpectatorDisplay> view_;  ///< declared after robot_, so destroyed before it
  bool begun_ = false;                      ///< true from the first tap on
};

PALPATE_PLUGIN(Backend, Baxter, "baxter", "left arm of a Baxter robot, over ROS 1")

}  // namespace palpate::baxter

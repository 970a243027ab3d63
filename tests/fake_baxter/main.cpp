// SPDX-License-Identifier: MIT
// fake_baxter CONFIG [KEY=VALUE ...]: simulates the robot of an experiment on the ROS network of ROS_MASTER_URI.
#include "config/compose.hpp"
#include "fake_baxter/node.hpp"
#include "host/plugin_host.hpp"
#include "record/resolved_config.hpp"
#include "scene/scene_options.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>

namespace palpate::fake_baxter {
namespace {

constexpr std::uint32_t kBurst = 100;  ///< queue length in messages per stream for faults that send bursts

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_signal(int) { stop = true; }

/// Provides the options of the backend baxter even if its plugin is not built.
class WithBaxter final : public PluginSource {
 public:
  explicit WithBaxter(const PluginHost& host) : host_(host) {}
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override {
    if (kind != "backend" || name != "baxter") return host_.describe(kind, name, fields);
    baxter::BaxterOptions options;
    options.list(fields);
  }

 private:
  const PluginHost& host_;
};

struct Arguments {
  std::string config;
  std::vector<std::string> overrides;
  NodeOptions node;
  std::vector<double> start_at;
  BodyOptions body;
  std::vector<std::string> faults;
  std::string at = "start";
  std::string companion;
};

ResolvedConfig read_config(const Arguments& a, const PluginSource& plugins) {
  Composer composer(std::filesystem::path(PALPATE_SOURCE_FOLDER) / "configs", config_keys());
  std::vector<Override> overrides;
  for (const std::string& text : a.overrides) overrides.push_back(parse_override(text));
  return resolve_experiment(composer.compose(a.config, overrides), plugins);
}

BodyOptions body_options(const Arguments& a, const baxter::BaxterOptions& baxter, std::uint64_t seed) {
  BodyOptions out = a.body;
  out.tool = baxter.tool;
  out.scene_pose = baxter.scene_pose;
  out.hover = baxter.motion.hover;
  out.seed = seed;
  if (!a.start_at.empty()) out.start_at = Eigen::Vector3d(a.start_at.data());
  if (a.node.rate <= 0.0) {
    out.begin = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  }
  return out;
}

/// Returns the role of the additional node of a fault, or an empty string.
std::string extra_node_of(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::second_sender:
      return "second_sender=" + fault.text;
    case FaultKind::speed_ratio:
      return fmt::format("set_speed_ratio={}", fault.amount);
    case FaultKind::command_timeout:
      return fmt::format("joint_command_timeout={}", fault.amount);
    default:
      return {};
  }
}

int run(const Arguments& a) {
  std::vector<Fault> faults;
  for (const std::string& words : a.faults) faults.push_back(parse_fault(words));
  const Trigger trigger = parse_trigger(a.at);
  const PluginHost host({std::filesystem::path(PALPATE_BUILD_FOLDER) / "lib" / "palpate"});
  const WithBaxter plugins(host);
  const ResolvedConfig config = read_config(a, plugins);
  if (config.options.backend.type != "baxter") {
    throw Error("backend", "is '" + config.options.backend.type + "', not 'baxter'", "add backend=fake_baxter");
  }
  baxter::BaxterOptions baxter;
  fill(*config.options.backend.options, plugins, "backend", [&](Fields& fields) { baxter.list(fields); });
  const auto seed = static_cast<std::uint64_t>(config.options.seed);
  const std::unique_ptr<const Scene> scene = build_scene(config.options.scene, seed, host);
  Body body(*scene, body_options(a, baxter, seed));
  ExtraNode gripper("end_effector");
  std::list<FaultNode> fault_nodes;
  for (const Fault& fault : faults) {
    body.inject(fault, starts_with_robot(fault.kind) ? Trigger{} : trigger);
    const std::string role = extra_node_of(fault);
    if (!role.empty()) fault_nodes.emplace_back(fault.kind, role);
  }
  NodeOptions node = a.node;
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::bursts || fault.kind == FaultKind::stall) node.queue = kBurst;
  }
  const baxter::ArmKinematics arm({0.0, 0.0, baxter.tool.gripper});
  serve(body, node, gripper, fault_nodes, arm, stop);
  return 0;
}

/// Adds all options except --companion.
void add_options(CLI::App& app, Arguments& a) {
  app.add_option("CONFIG", a.config, "YAML file of the experiment");
  app.add_option("OVERRIDE", a.overrides, "value of a key or name of a config group, as for 'palpate run'")
      ->type_name("KEY=VALUE");
  app.add_option("--rate", a.node.rate, "robot time per second of real time, published on /clock; 0: real time")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--patience", a.node.patience, "seconds that /clock waits for a driver that was sending commands")
      ->check(CLI::Range(0.0, 60.0));
  app.add_option("--start-at", a.start_at, "initial x,y,z of the tip in the frame of the scene, metres")
      ->expected(3)
      ->delimiter(',');
  app.add_option("--speed-ratio", a.body.speed_ratio,
                 "speed ratio (set_speed_ratio) that another program has set before")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--command-timeout", a.body.command_timeout,
                 "command timeout (joint_command_timeout) that another program has set before, seconds")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  using Arm = MechanicsOptions::Type;
  app.add_option("--arm", a.body.mechanics.type,
                 "model of the arm: lagged (joints without mass), springs (rigid bodies, by KDL) or mujoco")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Arm>{{"lagged", Arm::lagged}, {"springs", Arm::springs}, {"mujoco", Arm::mujoco}}));
  app.add_option("--friction", a.body.mechanics.friction,
                 "friction of every joint in the models springs and mujoco, Nm")
      ->check(CLI::Range(0.0, 5.0));
  app.add_option("--gripper", a.node.gripper,
                 "product name of the gripper that the robot recognises at its flange; not given: no gripper");
  app.add_option("--tool-mass", a.node.tool_mass,
                 "mass of the tool beyond the flange that the robot is configured with, kg")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--fault", a.faults, "fault to simulate: NAME or NAME=VALUE; can be repeated")->take_all();
  app.add_option("--at", a.at, "start of the faults: start, or DESCENT:HEIGHT above the desk, such as 2:8cm");
  app.add_option("--trace", a.node.trace, "CSV file to write, with one row per period");
  app.footer("Faults; those marked * hold from the start, whatever --at says:\n" + describe_faults());
}

int run_main(int argc, char** argv) {
  CLI::App app{
      "fake_baxter: simulates the left arm of a Baxter in the scene of an experiment, on a ROS network. All noise is\n"
      "drawn from the config's seed; its backend sets the tool and the pose of the scene.",
      "fake_baxter"};
  Arguments a;
  app.add_option("--companion", a.companion, "")->group("");
  add_options(app, a);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {
    return app.exit(wish);
  } catch (const CLI::Error& trouble) {
    throw Error("", trouble.what(), "see fake_baxter --help");
  }
  if (!a.companion.empty()) return serve_extra_node(a.companion);
  if (a.config.empty()) throw Error("", "CONFIG is required", "see fake_baxter --help");
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return run(a);
}

}  // namespace
}  // namespace palpate::fake_baxter

int main(int argc, char** argv) {
  try {
    return palpate::fake_baxter::run_main(argc, argv);
  } catch (const palpate::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return error.kind() == palpate::Error::Kind::usage ? 2 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fake_baxter: {}\n", error.what());
    return 1;
  }
}

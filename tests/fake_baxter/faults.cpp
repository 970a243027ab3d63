// SPDX-License-Identifier: MIT
#include "fake_baxter/faults.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace palpate::fake_baxter {
namespace {

enum class Takes { nothing, number, text };

constexpr double kAny = std::numeric_limits<double>::infinity();

struct Known {
  const char* name;
  const char* meaning;
  FaultKind kind;
  Takes takes = Takes::nothing;
  double amount = 0.0;
  const char* text = "";
  double least = -kAny, most = kAny;  ///< range of amount
};

constexpr Known kKnown[] = {
    {"estop", "somebody presses the emergency stop, and lets go after VALUE seconds (2)", FaultKind::estop,
     Takes::number, 2.0},
    {"stop", "a program stops the robot by /robot/set_super_stop", FaultKind::stop},
    {"error", "a joint has a fault: the robot reports an error and stops itself", FaultKind::error},
    {"complaint", "the robot reports an error of a component, which stops nothing and outlasts a reset",
     FaultKind::complaint},
    {"squish", "the firmware feels a collision, whatever the force", FaultKind::squish},
    {"freeze_endpoint", "endpoint_state goes on with fresh stamps, but pose and force stay the same",
     FaultKind::freeze_endpoint},
    {"kill_endpoint", "endpoint_state stops", FaultKind::kill_endpoint},
    {"kill_joints", "joint_states of the arm stop", FaultKind::kill_joints},
    {"kill_state", "/robot/state stops", FaultKind::kill_state},
    {"stale_stamps", "messages go on, but their stamps stay the same", FaultKind::stale_stamps},
    {"second_sender",
     "another node publishes the stream VALUE (state; endpoint, joints, collision, avoidance), too: that of a healthy "
     "robot that feels nothing",
     FaultKind::second_sender, Takes::text, 0.0, "state"},
    {"nan_wrench", "the force is not a number", FaultKind::nan_wrench},
    {"zero_wrench", "the force is exactly zero, as in Rethink's simulator", FaultKind::zero_wrench},
    {"bias", "the force gets VALUE newtons (12) on top, as though the tool were pressed upwards", FaultKind::bias,
     Takes::number, 12.0},
    {"spikes",
     "of the readings of the force the share VALUE (0.01) has 9 N on top, as though the tool were pressed upwards",
     FaultKind::spikes, Takes::number, 0.01, "", 0.0, 1.0},
    {"moving_force", "while the arm moves, the force has up to VALUE newtons (4) on top that go against the motion",
     FaultKind::moving_force, Takes::number, 4.0},
    {"drop_commands", "commands are ignored for VALUE seconds (5)", FaultKind::drop_commands, Takes::number, 5.0},
    {"jump_joints", "the measured left_s1 is off by VALUE radians (0.3) from now on", FaultKind::jump_joints,
     Takes::number, 0.3},
    {"old_state", "* /robot/state has the md5 sum of firmware before 1.2", FaultKind::old_state},
    {"no_data", "* of the stream VALUE (endpoint; joints, state, collision, avoidance) nothing ever comes",
     FaultKind::no_data, Takes::text, 0.0, "endpoint"},
    {"disabled", "* the robot begins disabled", FaultKind::disabled},
    {"tucked", "* the arm begins tucked and disabled, and refuses to be enabled", FaultKind::tucked},
    {"ik_invalid", "IKService says that there is no solution", FaultKind::ik_invalid},
    {"ik_slow", "IKService answers after VALUE seconds (5) of real time", FaultKind::ik_slow, Takes::number, 5.0},
    {"ik_absent", "* the robot has no IKService", FaultKind::ik_absent},
    {"software", "* the robot's software has version VALUE", FaultKind::software, Takes::text, 0.0, "1.1.1"},
    {"freeze_clock", "/clock stops; the robot goes on", FaultKind::freeze_clock},
    {"avoid", "the arm's collision avoidance keeps away from VALUE (torso; other_arm for the right arm)",
     FaultKind::avoid, Takes::text, 0.0, "torso"},
    {"speed_ratio", "another program, which stays, sets the speed ratio to VALUE (0.03)", FaultKind::speed_ratio,
     Takes::number, 0.03, "", 0.0, 1.0},
    {"command_timeout", "another program, which stays, sets the time-out of commands to VALUE seconds (0.02)",
     FaultKind::command_timeout, Takes::number, 0.02, "", 0.0, kAny},
    {"slow_endpoint", "endpoint_state comes VALUE times a second (25)", FaultKind::slow_endpoint, Takes::number, 25.0,
     "", 0.1, 100.0},
    {"slow_force", "the force in endpoint_state is another in every VALUE-th message (5) only", FaultKind::slow_force,
     Takes::number, 5.0, "", 1.0, kAny},
    {"caught", "from the next contact on the tool hangs on to what it touched, by a spring of VALUE N/m (3000)",
     FaultKind::caught, Takes::number, 3000.0, "", 1.0, kAny},
    {"bursts", "all that the robot says comes in bursts, one every VALUE seconds (0.045)", FaultKind::bursts,
     Takes::number, 0.045, "", 0.0, kAny},
    {"stall", "for VALUE seconds (0.05) nothing comes, then all of it", FaultKind::stall, Takes::number, 0.05, "", 0.0,
     kAny},
    {"delay", "every message, either way, takes VALUE seconds (0.04)", FaultKind::delay, Takes::number, 0.04, "", 0.0,
     kAny},
    {"jitter", "every message, either way, takes up to VALUE seconds (0.04) more", FaultKind::jitter, Takes::number,
     0.04, "", 0.0, kAny},
    {"wrench_filter", "the force passes a low-pass filter with a time constant of VALUE seconds (0.1)",
     FaultKind::wrench_filter, Takes::number, 0.1, "", 0.0, kAny},
    {"force_drift",
     "the force rises by VALUE newtons (35) per metre that the tip comes down, as though something "
     "pressed the tool upwards",
     FaultKind::force_drift, Takes::number, 35.0},
    {"die", "the program is gone at once", FaultKind::die},
};

constexpr const char* kStreams[] = {"endpoint", "joints", "state", "collision", "avoidance"};

double number(const Known& fault, const std::string& text) {
  char* end = nullptr;
  const double out = std::strtod(text.c_str(), &end);
  const bool fits = out >= fault.least && out <= fault.most;
  if (text.empty() || *end != '\0' || !std::isfinite(out) || !fits) {
    std::string range;
    if (std::isfinite(fault.least)) range += fmt::format(" from {} on", fault.least);
    if (std::isfinite(fault.most)) range = fmt::format(" from {} to {}", fault.least, fault.most);
    throw Error("--fault", std::string(fault.name) + " takes a number" + range + ", not '" + text + "'");
  }
  return out;
}

}  // namespace

Fault parse_fault(const std::string& words) {
  const std::size_t equals = words.find('=');
  const std::string name = words.substr(0, equals);
  for (const Known& one : kKnown) {
    if (name != one.name) continue;
    Fault out{one.kind, one.amount, one.text};
    if (equals == std::string::npos) return out;
    const std::string value = words.substr(equals + 1);
    if (one.takes == Takes::nothing) throw Error("--fault", name + " takes no value");
    if (one.takes == Takes::number) out.amount = number(one, value);
    if (one.takes == Takes::text) out.text = value;
    if ((one.kind == FaultKind::no_data || one.kind == FaultKind::second_sender) &&
        std::find(std::begin(kStreams), std::end(kStreams), value) == std::end(kStreams)) {
      throw Error("--fault", name + " takes endpoint, joints, state, collision or avoidance, not '" + value + "'");
    }
    return out;
  }
  std::vector<std::string> names;
  for (const Known& one : kKnown) names.emplace_back(one.name);
  throw Error("--fault", "there is no fault '" + name + "'", fmt::format("there are {}", fmt::join(names, ", ")));
}

std::string describe_faults() {
  std::string out;
  for (const Known& one : kKnown) out += fmt::format("  {:16} {}\n", one.name, one.meaning);
  return out;
}

bool starts_with_robot(FaultKind kind) {
  return std::any_of(std::begin(kKnown), std::end(kKnown),
                     [&](const Known& one) { return one.kind == kind && one.meaning[0] == '*'; });
}

Trigger parse_trigger(const std::string& words) {
  if (words == "start") return {};
  const std::size_t colon = words.find(':');
  char* end = nullptr;
  const long descent = std::strtol(words.c_str(), &end, 10);
  if (colon == std::string::npos || end != words.c_str() + colon || descent < 1 || descent > 100000) {
    throw Error("--at", "takes 'start' or DESCENT:HEIGHT, for example 2:8cm, not '" + words + "'");
  }
  return {static_cast<int>(descent), read_quantity(Tree::scalar(words.substr(colon + 1)), "--at", Unit::metre)};
}

}  // namespace palpate::fake_baxter

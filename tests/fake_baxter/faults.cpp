// SPDX-License-Identifier: MIT
#include "fake_baxter/faults.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <cmath>
#include <cstdlib>

namespace palpate::fake_baxter {
namespace {

enum class Takes { nothing, number, text };

struct Known {
  const char* name;
  FaultKind kind;
  Takes takes = Takes::nothing;
  double amount = 0.0;
  const char* text = "";
};

constexpr Known kKnown[] = {
    {"estop", FaultKind::estop, Takes::number, 2.0},
    {"stop", FaultKind::stop},
    {"error", FaultKind::error},
    {"complaint", FaultKind::complaint},
    {"squish", FaultKind::squish},
    {"freeze_endpoint", FaultKind::freeze_endpoint},
    {"kill_endpoint", FaultKind::kill_endpoint},
    {"kill_joints", FaultKind::kill_joints},
    {"kill_state", FaultKind::kill_state},
    {"stale_stamps", FaultKind::stale_stamps},
    {"second_state", FaultKind::second_state},
    {"nan_wrench", FaultKind::nan_wrench},
    {"zero_wrench", FaultKind::zero_wrench},
    {"bias", FaultKind::bias, Takes::number, 12.0},
    {"drop_commands", FaultKind::drop_commands, Takes::number, 5.0},
    {"jump_joints", FaultKind::jump_joints, Takes::number, 0.3},
    {"old_state", FaultKind::old_state},
    {"no_data", FaultKind::no_data, Takes::text, 0.0, "endpoint"},
    {"disabled", FaultKind::disabled},
    {"tucked", FaultKind::tucked},
    {"ik_invalid", FaultKind::ik_invalid},
    {"ik_slow", FaultKind::ik_slow, Takes::number, 5.0},
    {"ik_absent", FaultKind::ik_absent},
    {"software", FaultKind::software, Takes::text, 0.0, "1.1.1"},
    {"freeze_clock", FaultKind::freeze_clock},
    {"die", FaultKind::die},
};

constexpr const char* kStreams[] = {"endpoint", "joints", "state", "collision"};

std::string all_names() {
  std::string out;
  for (const Known& one : kKnown) out += (out.empty() ? "" : ", ") + std::string(one.name);
  return out;
}

double number(const std::string& fault, const std::string& text) {
  char* end = nullptr;
  const double out = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(out)) {
    throw Error("--fault", fault + " takes a number, not '" + text + "'");
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
    if (one.takes == Takes::number) out.amount = number(name, value);
    if (one.takes == Takes::text) out.text = value;
    if (one.kind == FaultKind::no_data) {
      bool stream = false;
      for (const char* known : kStreams) stream = stream || value == known;
      if (!stream) throw Error("--fault", "no_data takes endpoint, joints, state or collision, not '" + value + "'");
    }
    return out;
  }
  throw Error("--fault", "there is no fault '" + name + "'", "there are " + all_names());
}

bool starts_with_robot(FaultKind kind) {
  switch (kind) {
    case FaultKind::old_state:
    case FaultKind::no_data:
    case FaultKind::disabled:
    case FaultKind::tucked:
    case FaultKind::ik_absent:
    case FaultKind::software:
      return true;
    default:
      return false;
  }
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

// SPDX-License-Identifier: MIT
// The backend of a build without ROS: its options are those of the real one, so that what a robot recorded elsewhere
// can be read and replayed here; only tapping needs what this build has not.
#include "baxter/available.hpp"
#include "baxter/options.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

namespace palpate::baxter {
namespace {

/// The packages are those of packages.txt, heading ros.
constexpr const char* kAbsent =
    "this build has no ROS 1; 'sudo apt-get install --no-install-recommends " PALPATE_ROS_PACKAGES
    "' installs it, then build again, as ./palpate does by itself";

}  // namespace

bool available() { return false; }

class Absent final : public Backend {
 public:
  using Options = BaxterOptions;
  Absent(const Options&, const Context&) { throw Error("", kAbsent); }

  Contact tap(const TapRequest&) override { return {}; }
  bool repeatable() const override { return false; }
  bool scene_is_truth() const override { return false; }
};

PALPATE_PLUGIN(Backend, Absent, "baxter", "a Baxter over ROS 1, which this build does not have")

}  // namespace palpate::baxter

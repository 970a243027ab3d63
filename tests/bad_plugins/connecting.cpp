// SPDX-License-Identifier: MIT
// A backend that would connect to something whenever it is built: it then adds a line to the file that PALPATE_BUILT
// names, and waits for that of PALPATE_AWAITED to be there. It comes from any side but from where x is large, and what
// it taps is said to be the scene.
#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace broken {

class Backend final : public palpate::Backend {
 public:
  using Options = palpate::NoOptions;
  Backend(const Options&, const palpate::Context&) {
    if (const char* const file = std::getenv("PALPATE_BUILT")) std::ofstream(file, std::ios::app) << "built\n";
    const char* const awaited = std::getenv("PALPATE_AWAITED");
    // Between two looks, not for an outcome: the test says when.
    while (awaited != nullptr && !std::ifstream(awaited)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  palpate::Contact tap(const palpate::TapRequest& request) override {
    palpate::Contact out{palpate::Outcome::contact, 0.05, 8.0, 1.0, {}};
    if (request.approach) out.along = 0.2;
    return out;
  }
  bool reaches(const palpate::Approach& approach) const override { return approach.line.direction.x() > -0.2; }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }
};

PALPATE_PLUGIN(palpate::Backend, Backend, PLUGIN_NAME, "connects when it is built")

}  // namespace broken

// SPDX-License-Identifier: MIT
// Backend that simulates a connection when it is created. It appends a line to the file in PALPATE_BUILT and waits for
// the file in PALPATE_AWAITED. It can tap from any side except where x is large, and its scene counts as the truth.
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
    // Sleep between two checks; the test decides when to continue.
    while (awaited != nullptr && !std::ifstream(awaited)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  palpate::TapResult tap(const palpate::TapRequest& request) override {
    if (request.line.from_above) return palpate::contact_on(request.line, 0.05, 8.0, 1.0);
    constexpr double kDistance = 0.2;  // metres
    palpate::TapResult out = palpate::contact_on(request.line, 0.0, 8.0, 1.0);
    out.distance = kDistance;
    out.contact = request.line.at(kDistance);
    return out;
  }
  bool taps_any_line() const override { return true; }
  void reaches(const palpate::Candidates& lines, palpate::BoolOut out) const override {
    for (Eigen::Index i = 0; i < lines.size(); ++i) out(i) = lines.line(i).direction.x() > -0.2;
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }
};

PALPATE_PLUGIN(palpate::Backend, Backend, PLUGIN_NAME, "connects when it is built")

}  // namespace broken

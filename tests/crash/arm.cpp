// SPDX-License-Identifier: MIT
// A backend that stands for an arm: no tap can be repeated, and each is noted in the file that PALPATE_ARM_TAPS names,
// whatever becomes of its record.
#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace arm {

struct Options : palpate::Options {
  void list(palpate::Fields&) override {}
};

class Backend final : public palpate::Backend {
 public:
  using Options = arm::Options;
  explicit Backend(const Options&, const palpate::Context&) {}

  palpate::TapResult tap(const palpate::TapRequest& request) override {
    const std::string line = std::to_string(request.number) + "\n";
    const char* file = std::getenv("PALPATE_ARM_TAPS");
    const int number = ::open(file == nullptr ? "" : file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    const bool noted = ::write(number, line.data(), line.size()) > 0;
    ::close(number);
    if (!noted) throw palpate::Error("PALPATE_ARM_TAPS", "cannot be written", {}, palpate::Error::Kind::run);
    return palpate::contact_on(request.line, 0.01 * request.number, 8.0, 1.0);
  }
  bool repeatable() const override { return false; }
  bool scene_is_truth() const override { return false; }
};

PALPATE_PLUGIN(palpate::Backend, Backend, "arm", "notes every tap")

}  // namespace arm

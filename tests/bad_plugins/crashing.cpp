// SPDX-License-Identifier: MIT
// Backend that ends its process in the fifth tap, in the requested way; a sweep must survive it.
#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <csignal>
#include <cstdlib>

namespace broken {

struct Options : palpate::Options {
  enum class Way { none, crash, kill, exit, leave, fail };
  Way way = Way::none;
  void list(palpate::Fields& fields) override {
    fields.choice(way, palpate::Field("way", "how its process ends"),
                  {{"none", "not at all", {}},
                   {"crash", "by a crash", {}},
                   {"kill", "as if memory had run out", {}},
                   {"exit", "by a call of exit", {}},
                   {"leave", "by a call of exit that says all is well", {}},
                   {"fail", "not at all, but the run fails", {}}});
  }
};

class Backend final : public palpate::Backend {
 public:
  using Options = broken::Options;
  explicit Backend(const Options& options, const palpate::Context&) : way_(options.way) {}

  palpate::TapResult tap(const palpate::TapRequest& request) override {
    if (request.number == 5 && way_ == Options::Way::crash) {
      std::signal(SIGSEGV, SIG_DFL);  // without the handler of a sanitizer
      std::raise(SIGSEGV);
    }
    if (request.number == 5 && way_ == Options::Way::kill) std::raise(SIGKILL);
    if (request.number == 5 && way_ == Options::Way::exit) std::_Exit(3);
    if (request.number == 5 && way_ == Options::Way::leave) std::_Exit(0);
    if (request.number == 5 && way_ == Options::Way::fail) {
      throw palpate::Error("", "its arm has fallen off", {}, palpate::Error::Kind::run);
    }
    return palpate::contact_on(request.line, 0.01 * request.number, 8.0, 1.0);
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return false; }

 private:
  Options::Way way_;
};

PALPATE_PLUGIN(palpate::Backend, Backend, PLUGIN_NAME, "takes its process down")

}  // namespace broken

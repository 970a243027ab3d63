// Result of a tap, here on a computed dome in the middle of the desk. A real backend would move a robot.
#include <palpate/backend.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>

using namespace palpate;

struct MyBackendOptions : Options {
  double radius = 0.06;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.real(radius, Field("radius", "radius of the dome").in(Unit::metre).above(0));
    fields.real(height, Field("height", "height of the top above the desk").in(Unit::metre).at_least(0));
  }
};

class MyBackend final : public Backend {
 public:
  using Options = MyBackendOptions;
  MyBackend(const Options& options, const Context& context) : options_(options), scene_(context.scene) {}

  TapResult tap(const TapRequest& request) override {
    const Target target = request.line.target();
    const double r = math::hypot(target.x - scene_.area().width / 2, target.y - scene_.area().depth / 2);
    const double rise = std::sqrt(std::max(0.0, 1 - r * r / (options_.radius * options_.radius)));
    constexpr double kForce = 1.0;    // newtons
    constexpr double kSeconds = 5.0;  // robot time
    return contact_on(request.line, scene_.desk() + options_.height * rise, kForce, kSeconds);
  }

  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return false; }

 private:
  Options options_;
  const Scene& scene_;
};

PALPATE_PLUGIN(Backend, MyBackend, "starter", "custom backend: a simulated dome")

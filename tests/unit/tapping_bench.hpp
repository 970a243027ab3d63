// SPDX-License-Identifier: MIT
// A simulator over a scene given in YAML, for tests of taps.
#pragma once

#include "scene/scene_options.hpp"
#include "support/filled.hpp"
#include "support/requests.hpp"
#include "support/testing.hpp"

#include <palpate/backend.hpp>

namespace palpate::test {

class TappingBench {
 public:
  /// `objects` is a YAML list, `effects` and `motion` are YAML maps.
  TappingBench(const std::string& objects, const std::string& effects, const std::string& motion,
               std::uint64_t seed = 1)
      : scene_(build_scene(filled<SceneOptions>("{area: {width: 23 cm, depth: 23 cm}, objects: " + objects +
                                                ", effects: " + effects + "}"),
                           seed, shared_host())),
        context_{shared_host(), *scene_, seed, nullptr},
        backend_(context_.create<Backend>(choose(shared_host(), "backend", "simulator", "{motion: " + motion + "}"))) {}

  const Scene& scene() const { return *scene_; }
  Backend& backend() const { return *backend_; }

  TapResult tap(double x, double y, int number = 1) const { return backend_->tap(request_at({x, y}, number)); }

  /// Taps at `count` random places of the area.
  struct Tapped {
    Target place;
    TapResult contact;
    double truth;
  };
  std::vector<Tapped> taps(int count) const {
    Random random(7, "places");
    std::vector<Tapped> out;
    std::optional<TapLine> previous;
    for (int i = 1; i <= count; ++i) {
      const Target place{0.23 * random.uniform(), 0.23 * random.uniform()};
      TapRequest request = request_at(place, i);
      request.previous = previous;
      out.push_back({place, backend_->tap(request), scene_->height(place.x, place.y)});
      previous = request.line;
    }
    return out;
  }

 private:
  std::unique_ptr<const Scene> scene_;
  Context context_;
  std::shared_ptr<Backend> backend_;
};

inline void expect_same(const TapResult& a, const TapResult& b) {
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.height(), b.height());
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.reason, b.reason);
}

/// What many taps amount to; contacts alone, but for the count of failures.
struct TapStatistics {
  double bias = 0.0;     ///< m
  double rms = 0.0;      ///< m
  double seconds = 0.0;  ///< a tap
  int failed = 0;
};

inline TapStatistics statistics_of(const std::vector<TappingBench::Tapped>& taps) {
  TapStatistics out;
  double squares = 0.0;
  for (const TappingBench::Tapped& one : taps) {
    if (one.contact.outcome != Outcome::contact) {
      ++out.failed;
      continue;
    }
    const double error = one.contact.height() - one.truth;
    out.bias += error;
    squares += error * error;
    out.seconds += one.contact.seconds;
  }
  const double contacts = static_cast<double>(taps.size()) - out.failed;
  out.bias /= contacts;
  out.seconds /= contacts;
  out.rms = std::sqrt(squares / contacts);
  return out;
}

/// The paper's object I in the middle of the area, and a bare desk.
constexpr const char* kObjectI = "[{type: wave, rotation: 90 deg}]";
constexpr const char* kBare = "[]";

}  // namespace palpate::test

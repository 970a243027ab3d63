// SPDX-License-Identifier: MIT
// Two plugins that exist in words only, and configs resolved against them.
#pragma once

#include "config/resolve.hpp"
#include "config/yaml.hpp"
#include "support/testing.hpp"

namespace palpate::test {

struct Several : Options {
  std::vector<PluginChoice> parts;
  void list(Fields& fields) override {
    fields.plugins(parts, "kernel", Field("parts", "list of kernels").needed());
    fields.require(!parts.empty(), "parts", "needs at least one kernel");
  }
};

/// Knows kernel/smooth with one option, kernel/rough with two, and kernel/many, which has kernels inside.
class TwoPlugins final : public PluginSource {
 public:
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override {
    double scale = 0.1;
    double nu = 1.5;
    if (name == "many") {
      Several().list(fields);
      return;
    }
    if (name != "smooth" && name != "rough") {
      throw Error("", "no plugin " + kind + "/" + name, suggestion(name, {"rough", "smooth"}));
    }
    fields.real(scale, Field("scale", "its reach").in(Unit::metre).above(0));
    if (name == "rough") fields.real(nu, Field("nu", "its order"));
  }
};

inline Tree resolved(Options& options, const std::string& text, ResolveNotes* notes = nullptr) {
  ResolveNotes own;
  return resolve(options, parse_yaml(text, "c.yaml"), TwoPlugins(), notes != nullptr ? *notes : own);
}

/// Where each value came from: "path@place ", one behind the other.
inline std::string origins(const ResolveNotes& notes) {
  std::string out;
  for (const auto& one : notes.origins) out += one.path + "@" + one.place + " ";
  return out;
}

template <class T>
std::string refusal(const std::string& text) {
  return error_of([&] {
    T options;
    resolved(options, text);
  });
}

}  // namespace palpate::test

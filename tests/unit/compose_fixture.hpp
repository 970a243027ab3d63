// SPDX-License-Identifier: MIT
// Files in a folder of their own, and what composing them gives or how it is refused.
#pragma once

#include "config/compose.hpp"
#include "config/yaml.hpp"
#include "experiment/experiment_options.hpp"
#include "support/testing.hpp"

namespace palpate::test {

class ComposeFixture : public InFolder {
 protected:
  ComposeFixture() {
    folder_.write("kernel/rbf.yaml", "kernel:\n  type: rbf\n  length_scale: 1.7 cm\n");
    folder_.write("kernel/rough.yaml", "kernel:\n  type: matern\n  length_scale: 2.5 cm\n  nu: 1.5\n");
  }

  Tree compose(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const auto file = folder_.write("c.yaml", text);
    std::vector<Override> parsed;
    for (const std::string& one : overrides) parsed.push_back(parse_override(one));
    return Composer("/nonexistent", config_keys()).compose(file, parsed);
  }

  /// The error with the folder's name left out.
  std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::string what = error_of([&] { compose(text, overrides); });
    const std::string prefix = folder_.path().string() + "/";
    for (auto at = what.find(prefix); at != std::string::npos; at = what.find(prefix)) what.erase(at, prefix.size());
    return what;
  }

  /// The value at `path` of what `text` composes to, as it is written; "-" if there is none.
  std::string value(const std::string& text, const std::string& path, const std::vector<std::string>& overrides = {}) {
    const Tree tree = compose(text, overrides);
    const Tree* found = tree.find_path(path);
    if (found == nullptr) return "-";
    return found->is_scalar() ? found->text : found->canonical();
  }
};

}  // namespace palpate::test

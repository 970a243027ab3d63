// SPDX-License-Identifier: MIT
// Configs, words of a command line, and what programs answer.
#include "fuzz/ground.hpp"
#include "fuzz/harness.hpp"

#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "process/protocol.hpp"
#include "record/resolved_config.hpp"
#include "support/requests.hpp"
#include "sweep/description.hpp"
#include "sweep/where_condition.hpp"

#include <palpate/error.hpp>

#include <cmath>
#include <stdexcept>

namespace palpate::fuzz {

void config(const std::string& bytes) {
  try {
    const std::filesystem::path file = ground().write("config.yaml", bytes);
    Composer composer(shipped_configs(), config_keys());
    const ResolvedConfig first = resolve_experiment(composer.compose(file, {}), host());
    const std::filesystem::path written = ground().write("again.yaml", to_yaml(first.tree));
    const ResolvedConfig second = resolve_experiment(composer.compose(written, {}), host());
    if (first.id != second.id) throw std::logic_error("written and read again, it is another config");
  } catch (const Error&) {
  }
}

namespace {

/// Whatever `read` does, as long as it is done or refused in words.
template <class Read>
void attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

}  // namespace

void words(const std::string& bytes) {
  attempt([&] { parse_override(bytes); });
  attempt([&] {
    const SweepDescription sweep(nullptr, parse_sweep_words({bytes}));
    if (sweep.combinations().empty()) return;
    overrides_of(sweep.combinations().front());
    overrides_of(sweep.combinations().back());
    sweep.written();
  });
  attempt([&] {
    const WhereCondition condition(Tree::scalar(bytes, true));
    condition.holds(
        [](const std::string& name) {
          return std::optional(WhereCondition::Value{name, name.size() % 2 == 0});
        },
        {"taps", "seed"});
  });
  attempt([&] {
    const std::optional<AnyQuantity> quantity = any_quantity(bytes);
    if (!quantity) return;
    const Tree again = Tree::scalar(write_quantity(quantity->value, quantity->unit));
    if (read_quantity(again, "it", quantity->unit) != quantity->value) {
      throw std::logic_error("a quantity, written and read again, is another");
    }
  });
}

void answer(const std::string& bytes) {
  constexpr double kLowest = -0.04;
  constexpr double kHighest = 0.135;
  const TapRequest request = test::request_at({0.1, 0.1}, 2);
  const process::Answer answer =
      process::read_answer(bytes, request, {kLowest, kHighest, ""}, process::ProtocolVersion::any_line);
  if (!answer.accepted) return;
  if (!answer.in_step) throw std::logic_error("an answer to another tap was accepted");
  const TapResult& result = answer.result;
  const double height = result.height();
  const bool plain = std::isfinite(height) && std::isfinite(result.force) && std::isfinite(result.seconds);
  if (!plain || height < kLowest || height > kHighest || result.force < 0.0 || result.force > 1000.0 ||
      result.seconds < 0.0) {
    throw std::logic_error("a number that no arm can have felt was accepted");
  }
}

}  // namespace palpate::fuzz

// SPDX-License-Identifier: MIT
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "math/instructions.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::math::HWY_NAMESPACE {
namespace {

int64_t target() { return HWY_TARGET; }

}  // namespace
}  // namespace palpate::math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::math {

HWY_EXPORT(target);

namespace {

constexpr const char* kBaseline = "baseline";

std::string name_of(int64_t one) {
  const std::string name = hwy::TargetName(one);
  if (one == HWY_STATIC_TARGET && name != "NEON") return kBaseline;
  return name == "AVX3" ? "AVX-512" : name;
}

/// Loops use the best of these, or the baseline.
void allow(int64_t targets) {
  hwy::DisableTargets(~targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

std::vector<std::string> instruction_sets() {
  const std::string before = instructions_in_use();
  std::vector<std::string> out;
  for (int64_t left = ~int64_t{0}; left != 0;) {
    allow(left);
    const int64_t best = HWY_DYNAMIC_DISPATCH(target)();
    if (!out.empty() && out.back() == name_of(best)) break;
    out.push_back(name_of(best));
    left &= ~(best | (best - 1));  // the higher the bit, the fewer the instructions
  }
  use_instructions(before);
  return out;
}

void use_instructions(std::string_view name) {
  for (int bit = 0; bit < 63; ++bit) {
    if (name_of(int64_t{1} << bit) == name && ((int64_t{1} << bit) & HWY_TARGETS) != 0)
      return allow(int64_t{1} << bit);
  }
}

std::string instructions_in_use() { return name_of(HWY_DYNAMIC_DISPATCH(target)()); }

std::string choose_instructions() {
  const char* const name = "PALPATE_INSTRUCTIONS";
  const char* const value = std::getenv(name);
  const std::string chosen = value != nullptr ? value : "";
  if (!chosen.empty() && chosen != kBaseline)
    throw Error(name, "unknown value '" + chosen + "'", std::string("write ") + kBaseline + ", or unset it");
  allow(chosen.empty() ? ~int64_t{0} : HWY_STATIC_TARGET);
  return instructions_in_use();
}

}  // namespace palpate::math
#endif

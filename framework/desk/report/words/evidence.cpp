// SPDX-License-Identifier: MIT
#include "report/words/evidence.hpp"

#include <algorithm>
#include <array>

namespace palpate {
namespace {

constexpr std::array<const char*, 3> kProcesses{"height_process.", "weight_process.", "surface_process."};

bool begins_with(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

bool is_null(const Scalar& value) { return std::holds_alternative<std::monostate>(value); }

}  // namespace

Evidence::Evidence(const Row& recorded, const Row& computed) {
  take(recorded, true);
  take(computed, false);
}

void Evidence::take(const Row& row, bool recorded) {
  // A process of the row before is not completed with fields of this one.
  std::vector<std::string> complete;
  for (const char* process : kProcesses) {
    if (has(std::string(process) + "signal")) complete.emplace_back(process);
  }
  if (has("p")) complete.emplace_back("footprint.");
  for (const auto& [name, value] : row.fields) {
    const auto in_name = [&field = name](const std::string& process) { return begins_with(field, process); };
    if (is_null(value) || has(name) || std::any_of(complete.begin(), complete.end(), in_name)) continue;
    fields_.push_back({name, value, recorded});
  }
}

const Evidence::Field* Evidence::find(std::string_view field) const {
  const auto found = std::find_if(fields_.begin(), fields_.end(), [&](const Field& one) { return one.name == field; });
  return found == fields_.end() ? nullptr : &*found;
}

std::optional<double> Evidence::number(std::string_view field) const {
  const Field* found = find(field);
  if (found == nullptr) return std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(&found->value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(&found->value);
  return real != nullptr ? std::optional<double>(*real) : std::nullopt;
}

std::string Evidence::text(std::string_view field) const {
  const Field* found = find(field);
  const auto* text = found != nullptr ? std::get_if<std::string>(&found->value) : nullptr;
  return text != nullptr ? *text : std::string();
}

std::optional<bool> Evidence::flag(std::string_view field) const {
  const Field* found = find(field);
  const auto* truth = found != nullptr ? std::get_if<bool>(&found->value) : nullptr;
  return truth != nullptr ? std::optional<bool>(*truth) : std::nullopt;
}

bool Evidence::recorded(std::string_view field) const {
  const Field* found = find(field);
  return found != nullptr && found->recorded;
}

std::string Evidence::star(std::string_view field) const { return recorded(field) ? std::string() : star(); }

std::string Evidence::star() const {
  starred_ = true;
  return "*";
}

std::vector<std::string> Evidence::below(const std::string& prefix) const {
  std::vector<std::string> out;
  for (const Field& field : fields_) {
    if (begins_with(field.name, prefix)) out.push_back(field.name.substr(prefix.size()));
  }
  return out;
}

}  // namespace palpate

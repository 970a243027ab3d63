// SPDX-License-Identifier: MIT
#include "report/words/explanation.hpp"

#include "record/fields.hpp"
#include "report/words/titles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

namespace palpate {

std::string Explanation::text() {
  playback_.advance_to(number_ - 1);
  explain();
  return text_.text();
}

std::string Explanation::heading(const std::string& where) const {
  return fmt::format("Tap {} of {}{}, run {} ({}): {}", number_, recording_.rows.size(),
                     recording_.summary ? "" : " so far", options_.name, recording_.config.id, where);
}

std::string Explanation::acquisition_words() const {
  const std::string& type = options_.acquisition.type;
  const std::vector<PluginListing> found = environment_.host.list("acquisition", type);
  if (const Tree* command = options_.acquisition.options->find("command"))
    return fmt::format("{}, command {}", type, command->text);
  return found.empty() || found.front().summary.empty() ? type : fmt::format("{} ({})", type, found.front().summary);
}

void Explanation::explain_runner_up(const std::string& where, double score, double second) {
  const double less = score - second;
  const std::string by =
      score == 0.0 ? fmt::format("{:.3g}", std::abs(less)) : fmt::format("{:.3g} %", 100.0 * std::abs(less / score));
  text_.add(fmt::format("Runner-up: {} with a score of {}, {}.", where, plain_words(second),
                        less == 0.0 ? "the same" : by + (less > 0.0 ? " less" : " more, which is a tie")));
}

void Explanation::explain_label() {
  for (const RelabelledContact& one : relabelled_in(recording_.summary.value_or(Row{}))) {
    if (one.tap != number_) continue;
    text_.add(fmt::format(
        "After all {} taps it is read as a contact {}, because the offset of motion and arm is known better by then.",
        recording_.rows.size(), one.on_object ? "with an object" : "with the desk"));
  }
}

void Explanation::explain_failure() {
  if (!recording_.failed() || number_ != static_cast<int>(recording_.rows.size())) return;
  const std::string reason = recording_.summary->text("stop_reason");
  text_.add(fmt::format("The run failed at this tap{}.", reason.empty() ? "" : ": " + reason));
}

void Explanation::explain_errors(const Row& before, const Row& after) {
  if (!recording_.truth_known()) return text_.add("The truth is not known, so neither is the error of the surface.");
  std::vector<std::string> lengths;
  std::vector<std::string> others;
  for (const RecordField& error : error_fields()) {
    const bool length = error.unit == Unit::metre;
    const auto words = length ? error_words : plain_words;
    const std::string from = number_words(before, error.name, words);
    const std::string to = number_words(after, error.name, words);
    if (from.empty() || to.empty()) continue;
    const bool same = from == to;
    const std::string change = same ? to : fmt::format("from {} to {}", from, to);
    if (length) lengths.push_back(fmt::format("{} {}{}", error.label, same ? "still " : "", change));
    if (!length) others.push_back(fmt::format("The {} {} {}.", error.label, same ? "stays" : "goes", change));
  }
  if (!lengths.empty())
    text_.add(fmt::format("{}: {}.", surface_error_title(recording_.is_any_side()), fmt::join(lengths, ", ")));
  for (const std::string& one : others) text_.add(one);
  if (lengths.empty() && others.empty())
    text_.add("The record has no errors from before and after it; 'palpate report' computes those of every tap.");
}

}  // namespace palpate

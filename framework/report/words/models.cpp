// SPDX-License-Identifier: MIT
#include "report/words/models.hpp"

#include <palpate/kernel.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// A GP and the record of a tap that describes it.
struct DescribedGp {
  const char* title;
  std::string prefix;  ///< prefix of the GP's fields in the record, with the dot
  bool metric;         ///< whether the targets are heights in metres; otherwise they are labels
  const PluginChoice& kernel;
  const PluginChoice& fitting;
  const Context& context;
  const Row& row;

  std::string amount(double value) const { return metric ? length_words(value) : plain_words(value); }
  std::string amount(const char* name) const {
    return number_words(row, prefix + name, metric ? length_words : plain_words);
  }
  std::optional<double> number(const char* name) const { return row.number(prefix + name); }
  std::string words(const char* name) const { return number_words(row, prefix + name); }
  std::string text(const char* name) const { return row.text(prefix + name); }
};

/// Returns "length scale" for "length_scale", "kernels.0: length scale" for "kernels.0.length_scale".
std::string parameter_words(std::string name) {
  const auto dot = name.rfind('.');
  if (dot != std::string::npos) name.replace(dot, 1, ": ");
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string kernel_words(const DescribedGp& subject) {
  std::string out = subject.kernel.type;
  // The kernel object provides the units, which the record lacks.
  const auto parameters = subject.context.create<Kernel>(subject.kernel)->parameters();
  const Row numbers = numbers_below(subject.row, subject.prefix + "kernel.");
  for (const auto& field : numbers.fields) {
    Unit unit = Unit::none;
    for (const KernelParameter& one : parameters) unit = one.name == field.first ? one.unit : unit;
    out += fmt::format(", {} {}", parameter_words(field.first),
                       number_words(numbers, field.first, unit == Unit::metre ? length_words : plain_words));
  }
  return out;
}

std::string fit_words(const DescribedGp& subject) {
  const std::optional<bool> changed = subject.row.flag(subject.prefix + "fit.changed");
  if (!changed)
    return subject.fitting.type == "fixed"
               ? "Its hyperparameters are those of the config (fitting: fixed)."
               : fmt::format("No fit ({}) was due after its latest tap: it keeps the hyperparameters that it had.",
                             subject.fitting.type);
  std::string out = fmt::format("Its latest tap was followed by a fit ({}), which {}", subject.fitting.type,
                                *changed ? "changed the hyperparameters" : "left the hyperparameters as they were");
  if (const std::string value = subject.words("fit.objective"); !value.empty()) out += "; objective " + value;
  if (const auto count = subject.number("fit.evaluations"))
    out += " after " + counted(std::lround(*count), "evaluation");
  const std::string reason = subject.text("fit.reason");
  return out + (reason.empty() ? "." : ": " + reason + ".");
}

void explain_likelihood(TextSections& sections, const DescribedGp& subject) {
  std::vector<std::string> parts;
  if (const std::string value = subject.words("log_marginal_likelihood"); !value.empty())
    parts.push_back("Log marginal likelihood " + value + " (of its taps under these hyperparameters: more is better)");
  if (const auto least = subject.number("condition")) {
    const auto digits = static_cast<int>(std::floor(std::log10(std::max(1.0, *least))));
    parts.push_back(fmt::format(
        "{}ondition of its matrix at least {:.2g}: {} the 16 digits of a number", parts.empty() ? "C" : "c", *least,
        digits == 0 ? "rounding costs none of" : fmt::format("rounding costs about {} of", digits)));
  }
  if (!parts.empty()) sections.add(fmt::format("{}.", fmt::join(parts, "; ")));
}

/// Returns a text about the engine, its approximation error, and jitter against rounding errors.
std::string rounding_words(const DescribedGp& subject) {
  const double bound = subject.number("error_bound").value_or(0.0);
  const double jitter = subject.number("jitter").value_or(0.0);
  return fmt::format(
      "Posterior engine: {}; it adds {} to the rounding{}. {}", subject.text("engine"),
      bound > 0.0 ? fmt::format("at most {:.1e}", bound) : "nothing", bound > 0.0 ? ", in signals" : "",
      jitter > 0.0 ? fmt::format("Its matrix was singular in double precision, so jitter was added to the diagonal, as "
                                 "if every tap had a noise of {} more: the model trusts its taps slightly less.",
                                 subject.amount(std::sqrt(jitter)))
                   : "No jitter was needed.");
}

void explain_process(TextSections& sections, const DescribedGp& subject) {
  if (!subject.number("signal")) return;
  sections.add(fmt::format("{}: kernel {}; signal {} and noise {} (standard deviations), prior mean {}{}. {}",
                           subject.title, kernel_words(subject), subject.amount("signal"), subject.amount("noise"),
                           subject.amount("mean"), subject.metric ? " above the desk" : "", fit_words(subject)));
  explain_likelihood(sections, subject);
  sections.add(rounding_words(subject));
}

void explain_range_of_weight(TextSections& sections, const Row& row, bool clipped) {
  const auto least = row.number("min_weight");
  const auto greatest = row.number("max_weight");
  if (!least || !greatest) return;
  std::string out = fmt::format("w runs from {} to {}", plain_words(*least), plain_words(*greatest));
  constexpr double kRounding = 1e-12;
  if (*least < -kRounding || *greatest > 1.0 + kRounding) {
    out += fmt::format(
        ". It leaves [0, 1] because it is a regression on the labels 0 and 1, not a probability: between near taps "
        "with different labels it overshoots. {}",
        clipped ? "The score takes it clipped to [0, 1] (belief.label.clip: true)."
                : "The score takes it as it comes (belief.label.clip: false).");
    return sections.add(out);
  }
  sections.add(out +
               (*least < 0.0 || *greatest > 1.0 ? ", which is within [0, 1] but for rounding." : ", within [0, 1]."));
}

/// Adds type, numbers and remark of a footprint that is not the label GP.
void explain_footprint(TextSections& sections, const Row& row, const std::string& type) {
  std::vector<std::string> numbers;
  const Row all = numbers_below(row, "footprint.");
  for (const auto& field : all.fields)
    numbers.push_back(fmt::format("{} {}", parameter_words(field.first), number_words(all, field.first)));
  sections.add(fmt::format("Footprint: {}; an object's outline is where its p is 1/2 or more{}.", type,
                           numbers.empty() ? "" : fmt::format(". Its numbers: {}", fmt::join(numbers, ", "))));
  if (const auto left = row.number("footprint.undiscovered_probability"))
    sections.add(fmt::format("The probability that an object of 3 cm or more is still undiscovered is {:.0f} %.",
                             100.0 * *left));
  if (const std::string remark = row.text("footprint.remark"); !remark.empty())
    sections.add(fmt::format("Its remark: {}.", remark));
}

}  // namespace

void explain_models(TextSections& sections, const Row& row, const ExperimentOptions& options,
                    const HeightMapOptions& own, const Context& context) {
  const bool shared = own.label.hyperparameters == LabelGpOptions::HyperparameterSource::shared;
  const PluginChoice height_kernel = own.height.kernel.value_or(options.kernel);
  const PluginChoice height_fitting = own.height.fitting.value_or(options.fitting);
  const PluginChoice label_kernel = shared ? height_kernel : own.label.kernel.value_or(options.kernel);
  const PluginChoice label_fitting = shared ? height_fitting : own.label.fitting.value_or(options.fitting);
  explain_process(sections, {"Height GP", "height_gp.", true, height_kernel, height_fitting, context, row});
  if (const std::string mean = number_words(row, "mean_standard_deviation", length_words); !mean.empty())
    sections.add(fmt::format("The standard deviation of the height is {} on average and {} at most.", mean,
                             number_words(row, "max_standard_deviation", length_words)));
  explain_process(sections, {"Label GP", "label_gp.", false, label_kernel, label_fitting, context, row});
  explain_range_of_weight(sections, row, own.label.clip);
  if (row.number("p")) explain_footprint(sections, row, own.footprint.type);
  explain_process(sections, {"Surface GP (from the taps on an object alone, with a free mean level)", "surface_gp.",
                             true, height_kernel, height_fitting, context, row});
}

}  // namespace palpate

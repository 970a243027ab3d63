// SPDX-License-Identifier: MIT
#include "report/words/explain_models.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// One process: whose fields, in what unit, and what the program holds of it now.
struct Subject {
  const char* title;
  std::string prefix;  ///< of its fields, with the dot
  bool metric;         ///< targets are metres, not labels
  const PluginChoice& kernel;
  const PluginChoice& fitting;
  const Process* process;
  const std::optional<ProcessState>& now;

  std::string amount(double value) const { return metric ? length_words(value) : plain_words(value); }
  std::string amount(const Evidence& evidence, const char* name) const {
    return evidence.shown(field(name), metric ? length_words : plain_words);
  }
  std::string field(const char* name) const { return prefix + name; }
};

/// "length_scale" is shown as "length scale", "kernels.0.length_scale" as "kernels.0: length scale".
std::string parameter_words(std::string name) {
  const auto dot = name.rfind('.');
  if (dot != std::string::npos) name.replace(dot, 1, ": ");
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string kernel_words(const Subject& subject, const Evidence& evidence) {
  const std::string prefix = subject.field("kernel.");
  std::string out = subject.kernel.type;
  for (const std::string& name : evidence.below(prefix)) {
    Unit unit = Unit::none;  // which unit a parameter has, no record says and no fit changes
    if (subject.now) {
      for (const KernelParameter& one : subject.now->kernel) unit = one.name == name ? one.unit : unit;
    }
    out += fmt::format(", {} {}", parameter_words(name),
                       evidence.shown(prefix + name, unit == Unit::metre ? length_words : plain_words));
  }
  return out;
}

std::string settings_words(const Subject& subject, const Evidence& evidence) {
  return fmt::format("signal {} and noise {} (standard deviations), prior mean {}{}",
                     subject.amount(evidence, "signal"), subject.amount(evidence, "noise"),
                     subject.amount(evidence, "mean"), subject.metric ? " above the desk" : "");
}

std::string fit_words(const Subject& subject, const Evidence& evidence) {
  const std::optional<bool> changed = evidence.flag(subject.field("fit.changed"));
  if (!changed) {
    return subject.fitting.type == "fixed"
               ? "Its hyperparameters are those of the config (fitting: fixed)."
               : fmt::format("No fit ({}) was due after its latest tap: it keeps the hyperparameters that it had.",
                             subject.fitting.type);
  }
  std::string out = fmt::format("Its latest tap was followed by a fit ({}), which {}{}", subject.fitting.type,
                                *changed ? "changed the hyperparameters" : "left the hyperparameters as they were",
                                evidence.star(subject.field("fit.changed")));
  if (const std::string value = evidence.shown(subject.field("fit.objective"), plain_words); !value.empty())
    out += "; objective " + value;
  const auto evaluations = [](double count) { return counted(std::lround(count), "evaluation"); };
  if (const std::string count = evidence.shown(subject.field("fit.evaluations"), evaluations); !count.empty())
    out += " after " + count;
  const std::string reason = evidence.text(subject.field("fit.reason"));
  return out + (reason.empty() ? "." : ": " + reason + ".");
}

std::string likelihood_words(const Subject& subject, const Evidence& evidence) {
  const std::string value = evidence.shown(subject.field("log_marginal_likelihood"), plain_words);
  std::string out =
      value.empty() ? value
                    : "Log marginal likelihood " + value + " (of its taps under these hyperparameters: more is better)";
  const std::string condition = subject.field("condition");
  if (const auto least = evidence.number(condition)) {
    const auto digits = static_cast<int>(std::floor(std::log10(std::max(1.0, *least))));
    out += fmt::format("{}ondition of its matrix at least {:.2g}{}: {} the 16 digits of a number",
                       out.empty() ? "C" : "; c", *least, evidence.star(condition),
                       digits == 0 ? "rounding costs none of" : fmt::format("rounding costs about {} of", digits));
  }
  return out.empty() ? out : out + ".";
}

std::string engine_words(const Subject& subject, const Evidence& evidence) {
  const std::string engine = evidence.text(subject.field("engine"));
  if (engine.empty()) return {};
  std::string out = fmt::format("Posterior engine: {}{}", engine, evidence.star(subject.field("engine")));
  // Reasons are not recorded tap by tap; another machine may have had another one.
  if (subject.now && subject.now->engine == engine)
    out += fmt::format(" ({}{})", subject.now->engine_reason, evidence.star());
  const double bound = evidence.number(subject.field("error_bound")).value_or(0.0);
  return out + (bound > 0.0 ? fmt::format("; it adds at most {:.1e}{} to the rounding, in signals.", bound,
                                          evidence.star(subject.field("error_bound")))
                            : "; it adds nothing to the rounding.");
}

/// What had to be done because numbers have sixteen digits.
std::string rounding_words(const Subject& subject, const Evidence& evidence) {
  const double jitter = evidence.number(subject.field("jitter")).value_or(0.0);
  const std::string star = evidence.star(subject.field("jitter"));
  std::string out = fmt::format("No jitter was needed{}", star);
  if (jitter > 0.0) {
    out = fmt::format(
        "Its matrix was singular in double precision, so jitter was added to the diagonal, as if every tap had a noise "
        "of {}{} more: the model is a little less sure of its taps",
        subject.amount(std::sqrt(jitter)), star);
  }
  if (subject.process == nullptr) return out + ".";
  const Process& process = *subject.process;
  if (process.set_aside() == 0 && process.variances_clamped() == 0) {
    return out + fmt::format("; no tap is set aside, no variance is clamped{}.", evidence.star());
  }
  if (process.set_aside() > 0) {
    out += fmt::format("; {}{} set aside, left out because the others tell all about them",
                       counted(process.set_aside(), "tap"), evidence.star());
  }
  if (process.variances_clamped() > 0) {
    out += fmt::format("; at {}{} rounding took the variance out of [0, prior], and it reads as the nearer end",
                       counted(process.variances_clamped(), "candidate"), evidence.star());
  }
  return out + ".";
}

/// `shares`: with the height process, of which all this is said already.
void explain_process(Page& page, const Evidence& evidence, const Subject& subject, bool shares = false) {
  page.say(fmt::format("{}: kernel {}; {}. {}", subject.title, kernel_words(subject, evidence),
                       settings_words(subject, evidence), fit_words(subject, evidence)));
  const std::string likelihood = likelihood_words(subject, evidence);
  if (!likelihood.empty()) page.say(likelihood);
  page.say(
      shares ? "It shares matrix, variance and engine with the height process: both have the same kernel and the same "
               "ratio of noise to signal."
             : engine_words(subject, evidence) + " " + rounding_words(subject, evidence));
}

void explain_deviation(Page& page, const Evidence& evidence) {
  const std::string mean = evidence.shown("mean_standard_deviation", length_words);
  if (mean.empty()) return;
  page.say(fmt::format("The standard deviation of the height is {} on average and {} at most.", mean,
                       evidence.shown("max_standard_deviation", length_words)));
}

void explain_range_of_weight(Page& page, const Evidence& evidence, bool clipped) {
  const auto least = evidence.number("min_weight");
  const auto greatest = evidence.number("max_weight");
  if (!least || !greatest) return;
  std::string out = fmt::format("w runs from {} to {}", evidence.shown("min_weight", plain_words),
                                evidence.shown("max_weight", plain_words));
  constexpr double kRounding = 1e-12;
  if (*least < -kRounding || *greatest > 1.0 + kRounding) {
    out += fmt::format(
        ". It leaves [0, 1] because it is a regression on the labels 0 and 1, not a probability: between near taps "
        "with "
        "different labels it overshoots. {}",
        clipped ? "The score takes it clipped to [0, 1] (weight.clip: true)."
                : "The score takes it as it comes (weight.clip: false).");
    return page.say(out);
  }
  page.say(out + (*least < 0.0 || *greatest > 1.0 ? ", which is within [0, 1] but for rounding." : ", within [0, 1]."));
}

/// Of a footprint that is not the weight: what it is, what it tells of itself, and its remark.
void explain_footprint(Page& page, const Evidence& evidence, const std::string& type) {
  const std::string prefix = "footprint.";
  std::vector<std::string> numbers;
  for (const std::string& name : evidence.below(prefix)) {
    if (const std::string value = evidence.shown(prefix + name, plain_words); !value.empty())
      numbers.push_back(parameter_words(name) + " " + value);
  }
  page.say(fmt::format("Footprint: {}; an object's outline is where its p is 1/2 or more{}.", type,
                       numbers.empty() ? "" : fmt::format(". It tells: {}", fmt::join(numbers, ", "))));
  if (const std::string remark = evidence.text("footprint.remark"); !remark.empty())
    page.say(fmt::format("Its remark: {}{}.", remark, evidence.star("footprint.remark")));
}

}  // namespace

void explain_place(Page& page, const Evidence& evidence, const std::string& footprint) {
  const auto shown = [&](const char* field) { return evidence.shown(field, plain_words); };
  if (!evidence.has("u")) return;
  std::string text = fmt::format("There u = {} (how little is known of the height: 0 all, 1 nothing)", shown("u"));
  if (evidence.has("p")) {
    text += fmt::format(", p = {} (the probability that an object is there, by footprint/{})", shown("p"), footprint);
  }
  if (evidence.has("w") && evidence.has("e")) {
    text += fmt::format(", w = {} (what speaks for an object: 0 desk, 1 object), e = u w = {}", shown("w"), shown("e"));
  }
  page.say(text + ".");
}

void explain_models(Page& page, const Evidence& evidence, const ExperimentOptions& options, const TapBelief& belief,
                    const TapRecord& now) {
  const HeightOptions& height = options.height;
  const WeightOptions& weight = options.weight;
  const PluginChoice& height_kernel = height.kernel ? *height.kernel : options.kernel;
  const PluginChoice& height_fitting = height.fitting ? *height.fitting : options.fitting;
  const bool shared = weight.hyperparameters == WeightOptions::Hyperparameters::shared;
  const TapBelief::Output heights = belief.height_process();
  const TapBelief::Output labels = belief.weight_process();
  explain_process(
      page, evidence,
      {"Height process", "height_process.", true, height_kernel, height_fitting, heights.process, now.height_process});
  explain_deviation(page, evidence);
  if (labels) {
    explain_process(page, evidence,
                    {"Weight process", "weight_process.", false,
                     weight.kernel && !shared ? *weight.kernel : (shared ? height_kernel : options.kernel),
                     weight.fitting && !shared ? *weight.fitting : (shared ? height_fitting : options.fitting),
                     labels.process, now.weight_process},
                    labels.process == heights.process);
    explain_range_of_weight(page, evidence, weight.clip);
  }
  if (now.footprint) explain_footprint(page, evidence, options.footprint.type);
  if (!belief.two_part()) return;
  explain_process(page, evidence,
                  {"Surface process (of the taps on an object alone, whose level is free)", "surface_process.", true,
                   height_kernel, height_fitting, belief.surface_process().process, now.surface_process});
}

}  // namespace palpate

// SPDX-License-Identifier: MIT
#include "analysis/compare_report.hpp"

#include "analysis/mean_output.hpp"
#include "analysis/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

/// Significant digits of the smallest mean in a table without intervals. If all means are 10 or more, they have no
/// decimals.
constexpr int kDigits = 2;

/// Significant digits of the smallest mean that has no interval, in a table with intervals. Text tables use the same
/// number.
constexpr int kDigitsBesideIntervals = 3;

/// Returns the scale of a metric over all rows. The comparisons of this metric have the indices `first`, `first` +
/// `step`, `first` + 2 * `step` and so on.
DisplayScale scale_of(const std::vector<Comparison>& comparisons, std::size_t first, std::size_t step, int digits) {
  std::vector<double> means;
  for (std::size_t i = first; i < comparisons.size(); i += step) {
    const std::vector<double> more = comparisons[i].means();
    means.insert(means.end(), more.begin(), more.end());
  }
  return readable_scale(comparisons[first].metric.unit, means, digits);
}

/// Returns the number of decimals, 0 to 9, for two significant digits of half the interval's width.
int decimals_of(const MeanInterval& ends, double factor) {
  const double half = 0.5 * (ends.high - ends.low) / factor;
  return half > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 9) : 0;
}

/// Returns "$3.21\ [3.02, 3.40]$". LaTeX's math mode prints a hyphen as a minus sign. Mean and bounds have the same
/// number of decimals, which depends on the width of the interval.
std::string latex_estimate(const DisplayScale& scale, const MeanEstimate& mean) {
  if (mean.count == 0) return "--";
  if (!mean.interval || scale.scientific || !(mean.interval->high > mean.interval->low))
    return fmt::format("${}$", scale.number(mean.mean));
  const int decimals = decimals_of(*mean.interval, scale.factor);
  const auto number = [&](double value) {
    const std::string text = fmt::format("{:.{}f}", value / scale.factor, decimals);
    return text.find_first_of("123456789") == std::string::npos && text[0] == '-' ? text.substr(1) : text;
  };
  return fmt::format("${}\\ [{}, {}]$", number(mean.mean), number(mean.interval->low), number(mean.interval->high));
}

bool has_taps(const Comparison& one) { return one.occasion && one.occasion->taps(); }

/// Order of the comparisons: all metrics at the first checkpoint (Comparison::occasion), then all metrics at the next
/// checkpoint, and so on.
struct MeansLayout {
  std::size_t metrics = 0;
  std::vector<DisplayScale> scales;  ///< one scale per metric

  std::string title(const std::vector<Comparison>& comparisons, std::size_t metric) const {
    return scales[metric].title(comparisons[metric].metric.name);
  }
};

MeansLayout layout_of(const std::vector<Comparison>& comparisons, int digits) {
  MeansLayout out;
  out.metrics =
      static_cast<std::size_t>(std::count_if(comparisons.begin(), comparisons.end(), [&](const Comparison& one) {
        return one.occasion == comparisons.front().occasion;
      }));
  for (std::size_t metric = 0; metric < out.metrics; ++metric)
    out.scales.push_back(scale_of(comparisons, metric, out.metrics, digits));
  return out;
}

/// Returns a table with one row per group and checkpoint. A row has the values of the keys that define the group,
/// followed by the cells that `show` adds for the means of all metrics.
template <class ShowMeans>
Table table_of(const std::vector<Comparison>& comparisons, const MeansLayout& layout, const ShowMeans& show) {
  Table out;
  for (std::size_t block = 0; block < comparisons.size(); block += layout.metrics) {
    const Comparison& first = comparisons[block];
    for (std::size_t i = 0; i < first.groups.size(); ++i) {
      if (first.groups[i].counts.all_are(ValueStatus::left_out)) continue;
      out.add_row();
      for (std::size_t key = 0; key < first.by.size(); ++key)
        out.show(first.by[key], first.groups[i].values[key], Table::Kind::text);
      if (has_taps(first)) out.show("taps", std::to_string(*first.occasion->taps()));
      std::vector<const MeanEstimate*> means;
      for (std::size_t metric = 0; metric < layout.metrics; ++metric)
        means.push_back(&comparisons[block + metric].groups[i].mean);
      show(out, means);
    }
  }
  return out;
}

/// Returns remarks about missing values: metrics that some runs lack, and jobs that failed or have not ended.
std::string remarks(const std::vector<Comparison>& comparisons, std::size_t metrics) {
  std::string out;
  for (std::size_t metric = 0; metric < metrics; ++metric) {
    const std::string& name = comparisons[metric].metric.name;
    const RecordField* field = find_summary_field(name);
    bool lacks = false;
    for (std::size_t i = metric; i < comparisons.size(); i += metrics) {
      for (const ComparedGroup& group : comparisons[i].groups)
        lacks = lacks || group.counts.of(ValueStatus::without_value) > 0;
    }
    if (!lacks) continue;
    out +=
        fmt::format("{}: mean over the runs that have a value{}.\n", name,
                    field != nullptr && !field->when_null.empty() ? fmt::format(" (else {})", field->when_null) : "");
  }
  int failed = 0;
  int unfinished = 0;
  int never = 0;
  for (const ComparedGroup& group : comparisons.front().groups) {
    never += group.never;
    failed += group.counts.of(ValueStatus::failed);
    unfinished += group.counts.of(ValueStatus::unfinished);
  }
  if (failed + unfinished > 0)
    out += fmt::format("{} jobs failed and {} have not ended: the means exclude them.\n", failed, unfinished);
  if (never > 0) out += fmt::format("{} jobs never reached the goal and count with their final values.\n", never);
  return out;
}

}  // namespace

std::string means_table(const std::vector<Comparison>& comparisons) {
  const MeansLayout layout = layout_of(comparisons, kDigits);
  const Table table = table_of(comparisons, layout, [&](Table& out, const auto& means) {
    for (std::size_t i = 0; i < means.size(); ++i)
      out.show(layout.title(comparisons, i), means[i]->count > 0 ? layout.scales[i].number(means[i]->mean) : "-");
  });
  const std::string notes = remarks(comparisons, layout.metrics);
  return table.markdown() + (notes.empty() ? "" : "\n" + notes);
}

std::string latex_table(const std::vector<Comparison>& comparisons) {
  const MeansLayout layout = layout_of(comparisons, kDigitsBesideIntervals);
  // A single column n is enough if all metrics have equal n.
  bool same = true;
  std::size_t least = SIZE_MAX;
  std::size_t most = 0;
  table_of(comparisons, layout, [&](Table& /*out*/, const auto& means) {
    for (const MeanEstimate* mean : means) {
      same = same && mean->count == means.front()->count;
      least = std::min(least, mean->clusters);
      most = std::max(most, mean->clusters);
    }
  });
  const Table table = table_of(comparisons, layout, [&](Table& out, const auto& means) {
    for (std::size_t i = 0; i < means.size(); ++i) {
      out.show(latex_text(layout.title(comparisons, i)), latex_estimate(layout.scales[i], *means[i]),
               Table::Kind::latex);
      if (!same || i + 1 == means.size()) out.show("$n$", std::to_string(means[i]->count), Table::Kind::latex);
    }
  });
  std::string out = "% \\usepackage{booktabs}\n";
  out += fmt::format("% mean [95 % interval of the mean] and number of jobs; units of the intervals: {}\n",
                     units_words(least, most, comparisons.front().by_seed));
  std::string notes = remarks(comparisons, layout.metrics);
  for (std::size_t begin = 0, end; (end = notes.find('\n', begin)) != std::string::npos; begin = end + 1)
    out += "% " + notes.substr(begin, end - begin) + "\n";
  return out + table.latex();
}

}  // namespace palpate

// SPDX-License-Identifier: MIT
#include "analysis/compare_report.hpp"

#include "analysis/readable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string_view>
#include <utility>

namespace palpate {
namespace {

/// Means alone have two digits of the least: tens and hundreds then have no decimals that nobody reads.
constexpr int kDigits = 2;

/// Means beside their intervals: those that have none, as in the tables of text.
constexpr int kDigitsBesideIntervals = 3;

/// Of a metric in all rows, so that a column has one unit: `first` is its first comparison, the next ones are `step`
/// behind each other.
Scale scale_of(const std::vector<Comparison>& comparisons, std::size_t first, std::size_t step, int digits) {
  std::vector<double> means;
  for (std::size_t i = first; i < comparisons.size(); i += step) {
    const std::vector<double> more = comparisons[i].means();
    means.insert(means.end(), more.begin(), more.end());
  }
  return readable_scale(comparisons[first].metric.unit, means, digits);
}

/// A '|' in a name would end its cell.
std::string markdown_cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

std::string markdown_line(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

/// Text in which LaTeX sees no command. What begins with '[' would be taken for an argument of the line before it.
std::string latex_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) {
      out += std::string("\\") + c;
    } else if (c == '\\' || c == '~' || c == '^') {
      out += c == '\\' ? "\\textbackslash{}" : c == '~' ? "\\textasciitilde{}" : "\\textasciicircum{}";
    } else {
      out += c;
    }
  }
  return !out.empty() && out.front() == '[' ? "{" + out + "}" : out;
}

std::string latex_line(const std::vector<std::string>& cells) {
  return fmt::format("{} \\\\\n", fmt::join(cells, " & "));
}

/// The decimals by which half the width of an interval has two significant digits, 0 to 9.
int decimals_of(const MeanInterval& ends, double factor) {
  const double half = 0.5 * (ends.high - ends.low) / factor;
  return half > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 9) : 0;
}

/// "$3.21\ [3.02, 3.40]$": as mathematics, so that a minus is one. The digits follow from the interval, and mean and
/// bounds have as many decimals.
std::string latex_estimate(const Scale& scale, const MeanEstimate& mean) {
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

/// The comparisons of a table: `metrics` at an occasion, then as many at the next one.
struct MeansLayout {
  std::size_t metrics = 0;
  std::vector<Scale> scales;  ///< of each metric
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

/// Calls `write` for each row: its names, and the group of each metric.
void for_each_row(
    const std::vector<Comparison>& comparisons, const MeansLayout& layout,
    const std::function<void(std::vector<std::string> names, const std::vector<const ComparedGroup*>& groups)>& write) {
  for (std::size_t block = 0; block < comparisons.size(); block += layout.metrics) {
    const Comparison& first = comparisons[block];
    for (std::size_t i = 0; i < first.groups.size(); ++i) {
      if (first.groups[i].counts.all_are(Fate::left_out)) continue;
      std::vector<std::string> names = first.groups[i].values;
      if (has_taps(first)) names.push_back(std::to_string(*first.occasion->taps()));
      std::vector<const ComparedGroup*> groups;
      for (std::size_t metric = 0; metric < layout.metrics; ++metric)
        groups.push_back(&comparisons[block + metric].groups[i]);
      write(std::move(names), groups);
    }
  }
}

/// The titles of the columns that name a row.
std::vector<std::string> name_titles(const Comparison& first) {
  std::vector<std::string> out = first.by;
  if (has_taps(first)) out.emplace_back("taps");
  return out;
}

/// What is in no mean, or not in all: a metric that some runs lack, jobs that failed or have not ended.
std::string remarks(const std::vector<Comparison>& comparisons, std::size_t metrics) {
  std::string out;
  for (std::size_t metric = 0; metric < metrics; ++metric) {
    const std::string& name = comparisons[metric].metric.name;
    const RecordField* field = find_summary_field(name);
    bool lacks = false;
    for (std::size_t i = metric; i < comparisons.size(); i += metrics) {
      for (const ComparedGroup& group : comparisons[i].groups)
        lacks = lacks || group.counts.of(Fate::without_value) > 0;
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
    failed += group.counts.of(Fate::failed);
    unfinished += group.counts.of(Fate::unfinished);
  }
  if (failed + unfinished > 0)
    out += fmt::format("{} jobs failed and {} have not ended: the means exclude them.\n", failed, unfinished);
  if (never > 0) out += fmt::format("{} jobs never reached the goal and count with their final values.\n", never);
  return out;
}

}  // namespace

std::string means_table(const std::vector<Comparison>& comparisons) {
  const MeansLayout layout = layout_of(comparisons, kDigits);
  std::vector<std::string> titles = name_titles(comparisons.front());
  std::vector<std::string> sides(comparisons.front().by.size(), "---");
  for (std::size_t i = 0; i < layout.metrics; ++i) titles.push_back(layout.scales[i].title(comparisons[i].metric.name));
  sides.resize(titles.size(), "---:");
  for (std::string& title : titles) title = markdown_cell(title);
  std::string out = markdown_line(titles) + fmt::format("|{}|\n", fmt::join(sides, "|"));
  for_each_row(comparisons, layout, [&](std::vector<std::string> cells, const auto& groups) {
    for (std::string& cell : cells) cell = markdown_cell(cell);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const MeanEstimate& mean = groups[i]->mean;
      cells.push_back(mean.count > 0 ? layout.scales[i].number(mean.mean) : "-");
    }
    out += markdown_line(cells);
  });
  const std::string notes = remarks(comparisons, layout.metrics);
  return out + (notes.empty() ? "" : "\n" + notes);
}

std::string latex_table(const std::vector<Comparison>& comparisons) {
  const Comparison& first = comparisons.front();
  const MeansLayout layout = layout_of(comparisons, kDigitsBesideIntervals);
  // One column with n where it is the same for all metrics.
  bool same = true;
  std::size_t least = SIZE_MAX;
  std::size_t most = 0;
  std::string lines;
  for_each_row(comparisons, layout, [&](const auto&, const auto& groups) {
    for (const ComparedGroup* group : groups) {
      same = same && group->mean.count == groups.front()->mean.count;
      least = std::min(least, group->mean.clusters);
      most = std::max(most, group->mean.clusters);
    }
  });
  std::vector<std::string> titles = name_titles(first);
  for (std::string& title : titles) title = latex_cell(title);
  std::string sides = std::string(first.by.size(), 'l') + std::string(titles.size() - first.by.size(), 'r');
  for (std::size_t i = 0; i < layout.metrics; ++i) {
    titles.push_back(latex_cell(layout.scales[i].title(comparisons[i].metric.name)));
    sides += 'r';
    if (same && i + 1 < layout.metrics) continue;
    titles.emplace_back("$n$");
    sides += 'r';
  }
  for_each_row(comparisons, layout, [&](std::vector<std::string> cells, const auto& groups) {
    for (std::string& cell : cells) cell = latex_cell(cell);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      cells.push_back(latex_estimate(layout.scales[i], groups[i]->mean));
      if (!same || i + 1 == groups.size()) cells.push_back(std::to_string(groups[i]->mean.count));
    }
    lines += latex_line(cells);
  });
  std::string out = "% \\usepackage{booktabs}\n";
  out += fmt::format("% mean [95 % interval of the mean] and number of jobs; units of the intervals: {}\n",
                     units_words(least, most, first.by_seed));
  std::string notes = remarks(comparisons, layout.metrics);
  for (std::size_t begin = 0, end; (end = notes.find('\n', begin)) != std::string::npos; begin = end + 1)
    out += "% " + notes.substr(begin, end - begin) + "\n";
  return out + fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\midrule\n{}\\bottomrule\n\\end{{tabular}}\n",
                           sides, latex_line(titles), lines);
}

}  // namespace palpate

// SPDX-License-Identifier: MIT
#include "analysis/compare_report.hpp"

#include "analysis/readable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {
namespace {

/// Two digits of the least: means of tens and hundreds then have no decimals that nobody reads.
constexpr int kDigits = 2;

/// Of a metric in all rows, so that a column has one unit: `first` is its first comparison, the next ones are `step`
/// behind each other.
Scale scale_of(const std::vector<Comparison>& comparisons, std::size_t first, std::size_t step) {
  std::vector<double> means;
  for (std::size_t i = first; i < comparisons.size(); i += step) {
    const std::vector<double> more = comparisons[i].means();
    means.insert(means.end(), more.begin(), more.end());
  }
  return readable_scale(comparisons[first].metric.unit, means, kDigits);
}

/// A '|' in a name would end its cell.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

std::string line_of(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

bool has_taps(const Comparison& one) { return one.occasion && one.occasion->taps(); }

std::string head(const std::vector<Comparison>& comparisons, const std::vector<Scale>& scales) {
  const Comparison& first = comparisons.front();
  std::vector<std::string> names;
  for (const std::string& key : first.by) names.push_back(cell(key));
  std::vector<std::string> sides(names.size(), "---");
  if (has_taps(first)) names.emplace_back("taps");
  for (std::size_t i = 0; i < scales.size(); ++i) names.push_back(cell(scales[i].title(comparisons[i].metric.name)));
  sides.resize(names.size(), "---:");
  return line_of(names) + fmt::format("|{}|\n", fmt::join(sides, "|"));
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
        fmt::format("{}: mean over the runs that have one{}.\n", name,
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
    out += fmt::format("{} jobs failed and {} have not ended: they are in no mean.\n", failed, unfinished);
  if (never > 0) out += fmt::format("{} jobs never got there and count as they ended.\n", never);
  return out;
}

}  // namespace

std::string means_table(const std::vector<Comparison>& comparisons) {
  const auto metrics =
      static_cast<std::size_t>(std::count_if(comparisons.begin(), comparisons.end(), [&](const Comparison& one) {
        return one.occasion == comparisons.front().occasion;
      }));
  std::vector<Scale> scales;
  for (std::size_t metric = 0; metric < metrics; ++metric) scales.push_back(scale_of(comparisons, metric, metrics));
  std::string out = head(comparisons, scales);
  for (std::size_t block = 0; block < comparisons.size(); block += metrics) {
    const Comparison& first = comparisons[block];
    for (std::size_t i = 0; i < first.groups.size(); ++i) {
      if (first.groups[i].counts.all_are(Fate::left_out)) continue;
      std::vector<std::string> cells;
      for (const std::string& value : first.groups[i].values) cells.push_back(cell(value));
      if (has_taps(first)) cells.push_back(std::to_string(*first.occasion->taps()));
      for (std::size_t metric = 0; metric < metrics; ++metric) {
        const MeanEstimate& mean = comparisons[block + metric].groups[i].mean;
        cells.push_back(mean.count > 0 ? scales[metric].number(mean.mean) : "-");
      }
      out += line_of(cells);
    }
  }
  const std::string notes = remarks(comparisons, metrics);
  return out + (notes.empty() ? "" : "\n" + notes);
}

}  // namespace palpate

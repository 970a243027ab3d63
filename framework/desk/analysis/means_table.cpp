// SPDX-License-Identifier: MIT
#include "analysis/means_table.hpp"

#include "analysis/readable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {
namespace {

/// Two digits of the least: means of tens and hundreds then have no decimals that nobody reads.
constexpr int kDigits = 2;

/// The comparisons after one number of taps: one a metric.
using Block = std::vector<const Comparison*>;

std::vector<Block> blocks_of(const std::vector<Comparison>& comparisons) {
  std::vector<Block> blocks;
  for (const Comparison& one : comparisons) {
    if (blocks.empty() || blocks.back().front()->after_taps != one.after_taps) blocks.emplace_back();
    blocks.back().push_back(&one);
  }
  return blocks;
}

/// Of a metric in all rows, so that a column has one unit.
std::vector<Scale> scales_of(const std::vector<Block>& blocks) {
  std::vector<Scale> scales;
  for (std::size_t metric = 0; metric < blocks.front().size(); ++metric) {
    std::vector<double> means;
    for (const Block& block : blocks) {
      for (const ComparedGroup& group : block[metric]->groups) {
        if (group.mean.count > 0) means.push_back(group.mean.mean);
      }
    }
    scales.push_back(readable_scale(blocks.front()[metric]->metric.unit, means, kDigits));
  }
  return scales;
}

/// A '|' in a name would end its cell.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

std::string line_of(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

std::string head(const std::vector<Block>& blocks, const std::vector<Scale>& scales) {
  const Comparison& first = *blocks.front().front();
  std::vector<std::string> names;
  std::vector<std::string> sides;
  for (const std::string& key : first.by) {
    names.push_back(cell(key));
    sides.emplace_back("---");
  }
  if (first.after_taps) names.emplace_back("taps");
  for (std::size_t i = 0; i < scales.size(); ++i)
    names.push_back(cell(scales[i].title(blocks.front()[i]->metric.name)));
  sides.resize(names.size(), "---:");
  return line_of(names) + "|" + fmt::format("{}", fmt::join(sides, "|")) + "|\n";
}

/// What is in no mean, or not in all: a metric that some runs lack, jobs that failed or have not ended.
std::string remarks(const std::vector<Block>& blocks) {
  std::string out;
  for (const Comparison* one : blocks.front()) {
    const RecordField* field = find_summary_field(one->metric.name);
    const bool lacks = std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) {
      const auto same = std::find_if(block.begin(), block.end(),
                                     [&](const Comparison* other) { return other->metric.name == one->metric.name; });
      return std::any_of((*same)->groups.begin(), (*same)->groups.end(),
                         [](const ComparedGroup& group) { return group.counts.without_value > 0; });
    });
    if (!lacks) continue;
    out +=
        fmt::format("{}: mean over the runs that have one{}.\n", one->metric.name,
                    field != nullptr && !field->when_null.empty() ? fmt::format(" (else {})", field->when_null) : "");
  }
  int failed = 0;
  int unfinished = 0;
  for (const ComparedGroup& group : blocks.front().front()->groups) {
    failed += group.counts.failed;
    unfinished += group.counts.unfinished;
  }
  if (failed + unfinished > 0)
    out += fmt::format("{} jobs failed and {} have not ended: they are in no mean.\n", failed, unfinished);
  return out;
}

}  // namespace

std::string means_table(const std::vector<Comparison>& comparisons) {
  const std::vector<Block> blocks = blocks_of(comparisons);
  const std::vector<Scale> scales = scales_of(blocks);
  std::string out = head(blocks, scales);
  for (const Block& block : blocks) {
    const Comparison& first = *block.front();
    for (std::size_t i = 0; i < first.groups.size(); ++i) {
      const JobCounts& counts = first.groups[i].counts;
      if (counts.left_out == counts.jobs) continue;
      std::vector<std::string> cells;
      for (const std::string& value : first.groups[i].values) cells.push_back(cell(value));
      if (first.after_taps) cells.push_back(std::to_string(*first.after_taps));
      for (std::size_t metric = 0; metric < block.size(); ++metric) {
        const MeanEstimate& mean = block[metric]->groups[i].mean;
        cells.push_back(mean.count > 0 ? scales[metric].number(mean.mean) : "-");
      }
      out += line_of(cells);
    }
  }
  const std::string notes = remarks(blocks);
  return out + (notes.empty() ? "" : "\n" + notes);
}

}  // namespace palpate

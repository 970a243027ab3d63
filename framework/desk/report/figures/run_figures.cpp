// SPDX-License-Identifier: MIT
#include "report/figures/gallery.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

std::string after_words(const Snapshot& snapshot) {
  return fmt::format("after tap {}: {}", snapshot.taps, count_words(snapshot.result));
}

}  // namespace

Figure surface_figure(const ExperimentOptions& options, const Ground& ground, const Snapshot& last) {
  Sheet sheet(1000, 700);
  const Raster raster(ground);
  sheet.data("surface", raster.surface(last.surface, last.deviation));
  const Snapshot seen = in_sight(last, ground);
  sheet.taps("last", seen);
  sheet.text(options.name, 30, 16, 15);
  const auto behind = last.marks.size() - seen.marks.size();
  sheet.text("surface " + after_words(last) + (behind > 0 ? fmt::format("; {} of them behind it", behind) : ""), 30, 44,
             11);
  const Colours colours = deviation_colours(last.deviation.minCoeff(), last.deviation.maxCoeff());
  sheet.surface({90, 80, 740, 510}, raster, "surface", "last", colours, relief_of({last}, ground));
  sheet.bar({880, 160, 18, 380}, colours);
  sheet.legend(36, 670, last.result.failed_taps > 0, false);
  return {"surface", std::move(sheet)};
}

Figure maps_figure(const ExperimentOptions& options, const Ground& ground, const Snapshot& last) {
  constexpr double kLeft = 70;
  constexpr double kTop = 118;
  constexpr double kStep = 440;
  constexpr double kSide = 290;
  const Raster raster(ground);
  const Box first = map_box(ground.area, kLeft, kTop, kSide);
  Sheet sheet(static_cast<int>(kLeft + 2 * kStep + kSide + 90), static_cast<int>(kTop + first.height + 96));
  struct Panel {
    const char* name;
    const Eigen::VectorXd& values;
    Palette palette;
    double high;  ///< from 0
    std::string words;
  };
  const auto outside = [](const Eigen::VectorXd& values, double high) {
    if (values.minCoeff() >= -5e-4 && values.maxCoeff() <= high + 5e-4) return std::string();
    return fmt::format("\nit goes from {:.2f} to {:.2f}", values.minCoeff(), values.maxCoeff());
  };
  // The strategy's score is u w only where there is a w.
  const Eigen::VectorXd e = last.has_weight() ? last.exploration() : last.scores;
  const double most = e.maxCoeff() > 0.0 ? e.maxCoeff() : 1.0;
  std::vector<Panel> panels{{"u", last.uncertainty, Palette::cividis, 1.0, "u: what is not known of the height"}};
  if (last.has_weight()) {
    panels.push_back(
        {"w", last.weight, Palette::viridis, 1.0, "w: whether there is an object" + outside(last.weight, 1)});
    panels.push_back({"e", e, Palette::viridis, most, "e = u w: the exploration function" + outside(e, most)});
  } else {
    const std::string by = fmt::format("by footprint/{}", options.footprint.type);
    const std::string of = fmt::format("score of acquisition/{}", options.acquisition.type);
    panels.push_back({"p", last.probability, Palette::viridis, 1.0, "p: the probability of an object,\n" + by});
    panels.push_back({"score", e, Palette::viridis, most, of + outside(e, most)});
  }
  sheet.text(options.name, kLeft, 14, 15);
  sheet.text(fmt::format("{}; strategy {}", after_words(last), options.acquisition.type), kLeft, 42, 11);
  for (const Panel& panel : panels) sheet.data(panel.name, raster.matrix(panel.values));
  sheet.taps("last", last);
  double left = first.left;
  for (const Panel& panel : panels) {
    const Colours colours{panel.palette, 0.0, panel.high, ""};
    sheet.text(panel.words, left + 0.5 * first.width, kTop - 44, 11, Sheet::Align::centre);
    sheet.map({left, kTop, first.width, first.height}, raster, panel.name, "last", colours);
    sheet.bar({left + first.width + 14, kTop, 14, first.height}, colours);
    left += kStep;
  }
  sheet.legend(kLeft + 6, kTop + first.height + 68, last.result.failed_taps > 0);
  return {"maps", std::move(sheet)};
}

}  // namespace palpate

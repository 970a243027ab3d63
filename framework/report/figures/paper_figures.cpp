// SPDX-License-Identifier: MIT
#include "analysis/groups.hpp"
#include "record/run_directory.hpp"
#include "report/figures/figure_layout.hpp"
#include "report/figures/figures.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

namespace palpate {
namespace {

/// States of one run for a figure that reproduces a figure of the paper (Sun and Min 2021, arXiv 2110.09593).
struct RunSnapshots {
  std::string strategy;
  std::vector<int> iterations;
  std::vector<MapsAtTap> snapshots;  ///< one per iteration
  SceneFrame frame;
};

/// A row of panels with one panel per snapshot of a run. The panels show surfaces from the side, or maps of the scores
/// or of u.
struct PanelRow {
  const RunSnapshots& run;
  Eigen::VectorXd MapsAtTap::*map;
};
constexpr double kLeft = 70;    // pixels left of the first panel, for an axis
constexpr double kRight = 150;  // pixels right of the last panel, for a scale
constexpr double kMap = 225;    // longer side of a map, pixels
constexpr double kStep = 312;   // distance between the left edges of neighbouring panels
constexpr double kHead = 48;    // height of the title
constexpr double kSurface = 200;

/// Returns the least and the greatest value of a map over the snapshots of a run.
std::pair<double, double> extent(const PanelRow& row) {
  std::pair<double, double> out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const MapsAtTap& one : row.run.snapshots) {
    const Eigen::VectorXd& map = one.*row.map;
    out = {std::min(out.first, map.minCoeff()), std::max(out.second, map.maxCoeff())};
  }
  return out;
}

bool is_surface(const PanelRow& row) { return row.map == &MapsAtTap::surface; }
bool is_scores(const PanelRow& row) { return row.map == &MapsAtTap::scores; }

ColourScale colours_of(const PanelRow& row) {
  if (is_surface(row)) {
    const auto [least, most] = extent({row.run, &MapsAtTap::deviation});
    return deviation_colours(least, most);
  }
  if (!is_scores(row)) return {Palette::cividis, 0.0, 1.0, "u"};
  const double high = extent(row).second;  // The scale begins at 0.
  return {Palette::viridis, 0.0, high > 0.0 ? high : 1.0, fmt::format("score ({})", row.run.strategy)};
}

/// Returns a note that some scores are below 0; "" if no score is below -0.005.
std::string below_zero_words(const std::vector<PanelRow>& rows) {
  double least = 0.0;
  for (const PanelRow& row : rows) least = is_scores(row) ? std::min(least, extent(row).first) : least;
  return least < -0.005 ? fmt::format("scores below 0, to {:.2f}, have the colour of 0", least) : "";
}

/// Returns the suffix of the names of a panel's data blocks.
std::string block_suffix(const RunSnapshots& progress, std::size_t column) {
  std::string out = fmt::format("{}_{}", progress.strategy, progress.iterations[column]);
  const auto is_other = [](unsigned char c) { return std::isalnum(c) == 0; };
  std::replace_if(out.begin(), out.end(), is_other, '_');
  return out;
}

double height_of(const PanelRow& row, const Box& map) { return is_surface(row) ? kSurface : map.height; }

/// Draws the panels of a row below `top`, and their colour bar. `map` is the box of the first map.
void draw_row(FigureLayout& layout, const PanelRow& row, double top, const Box& map) {
  const RunSnapshots& run = row.run;
  const ColourScale colours = colours_of(row);
  const ZRange z_range = z_range_of(run.snapshots, run.frame);
  double left = map.left;
  for (std::size_t i = 0; i < run.snapshots.size(); ++i, left += kStep) {
    const MapsAtTap& snapshot = run.snapshots[i];
    const std::string key = block_suffix(run, i);
    if (is_surface(row)) {
      layout.data("surface_" + key, surface_of(run.frame, snapshot.surface, snapshot.deviation));
      MapsAtTap seen = without_hidden_taps(snapshot, run.frame);
      seen.next.reset();  // Only the map shows the next tap.
      layout.taps("seen_" + key, seen);
      layout.surface({left - 4, top, map.width + 26, kSurface}, run.frame, "surface_" + key, "seen_" + key, colours,
                     z_range);
    } else {
      const std::string block = (is_scores(row) ? "scores_" : "u_") + key;
      layout.data(block, matrix_of(run.frame, snapshot.*row.map));
      layout.taps(key, snapshot);
      layout.map({left, top, map.width, map.height}, run.frame, block, key, colours);
    }
  }
  const double gap = is_surface(row) ? 48 : 22;  // leaves room for the axis of heights
  layout.bar({left - kStep + map.width + gap, top, 14, height_of(row, map)}, colours);
}

/// Returns the states of the run at these iterations of the paper. Iteration k of the paper is the state after the
/// initial taps and k - 1 further taps. If the run ended before an iteration, the state after the run's last tap is
/// shown instead, and all later iterations are left out.
RunSnapshots progress_of(const RunEnvironment& environment, const RecordedRun& recording,
                         const std::vector<int>& iterations) {
  const int all = static_cast<int>(recording.taps.size());
  const auto initial =
      static_cast<int>(std::count_if(recording.taps.begin(), recording.taps.end(),
                                     [](const TapRecord& tap) { return tap.request.source == Source::initial; }));
  RunReplay playback(environment, recording, page_readers(recording));
  std::vector<int> shown;
  std::vector<int> taps;
  for (const int one : iterations) {
    // Iteration 1 of the paper is the state after the initial taps.
    const int at = std::clamp(one + initial - 1, 1, all);
    if (!taps.empty() && at == taps.back()) break;  // The last tap is shown once.
    shown.push_back(one);
    taps.push_back(at);
  }
  return {recording.config.options.acquisition.type, shown, maps_at_taps(playback, recording, taps),
          scene_frame_of(playback.experiment())};
}

/// Draws rows of panels below each other. The rows belong to one run, or to several runs with equal numbers of
/// snapshots. `rows` must not be empty.
Figure panels_figure(const std::string& name, const std::string& title, const std::vector<PanelRow>& rows) {
  constexpr double kWords = 60;  // pixels above the first row of a run
  constexpr double kBelow = 54;  // pixels below a row
  const std::size_t columns = rows.front().run.snapshots.size();
  const bool several = &rows.front().run != &rows.back().run;
  const Box map = map_box(rows.front().run.frame.area, several ? kLeft + 24 : kLeft, 0, kMap);
  const auto begins_run = [&](std::size_t row) { return row == 0 || &rows[row].run != &rows[row - 1].run; };
  std::vector<double> tops;
  double bottom = kHead;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    tops.push_back(bottom + (begins_run(i) ? kWords : 0.0));
    bottom = tops.back() + height_of(rows[i], map) + kBelow;
  }
  FigureLayout layout(static_cast<int>(map.left + kStep * static_cast<double>(columns - 1) + kMap + kRight),
                      static_cast<int>(bottom + 40));
  layout.text(title, map.left, 14, 15);
  bool failed = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RunSnapshots& run = rows[i].run;
    for (std::size_t k = 0; begins_run(i) && k < columns; ++k) {
      const MapsAtTap& snapshot = run.snapshots[k];
      failed = failed || snapshot.result.failed_taps > 0;
      layout.text(
          fmt::format("iteration {}, after tap {}\n{}", run.iterations[k], snapshot.taps, count_words(snapshot.result)),
          map.left + kStep * static_cast<double>(k) + 0.5 * map.width, tops[i] - 52, 11, FigureLayout::Align::centre);
    }
    if (several) layout.vertical_text(run.strategy, 22, tops[i] + 0.5 * height_of(rows[i], map), 14);
    draw_row(layout, rows[i], tops[i], map);
  }
  if (const std::string words = below_zero_words(rows); !words.empty()) layout.text(words, 680, bottom + 6, 10);
  layout.legend(map.left + 6, bottom + 14, failed);
  return {name, std::move(layout)};
}

/// Draws a row of surfaces, and below it a row of maps of the strategy's scores, as in figures 2 and 3 of the paper.
Figure progress_figure(const std::string& name, const std::string& title, const RunSnapshots& progress) {
  return panels_figure(name, title, {{progress, &MapsAtTap::surface}, {progress, &MapsAtTap::scores}});
}

constexpr const char* kAllOfThem = "run configs/paper/figures.yaml, which has all of them";

/// Returns the jobs of this scene and strategy that ended without a failure, in the order of the sweep.
std::vector<const Job*> finished_jobs(const Sweep& sweep, const std::string& scene, const std::string& acquisition) {
  std::vector<const Job*> out;
  for (const Job& job : sweep.jobs) {
    if (value_of(sweep, job, "scene") == scene && value_of(sweep, job, "acquisition") == acquisition &&
        read_ending(job_directory(sweep, job)).state == RunStatus::State::done)
      out.push_back(&job);
  }
  return out;
}

/// Adds the seed to a title, if seeds are swept.
std::string title_with_seed(const std::string& title, const Sweep& sweep, const Job& job) {
  const std::string seed = value_of(sweep, job, "seed");
  return title + (seed.empty() ? "" : ", seed " + seed);
}

/// The figures of a sweep, and notes about figures for which a job is missing.
struct PaperFigures {
  const RunEnvironment& environment;
  const Sweep& sweep;
  std::vector<Figure> figures;
  std::vector<std::string> notes;

  PaperFigures(const RunEnvironment& from, const Sweep& of) : environment(from), sweep(of) {}

  RunSnapshots progress(const Job& job, const std::vector<int>& iterations) const {
    return progress_of(environment, read_recorded_run(environment.host, job_directory(sweep, job)), iterations);
  }

  /// Adds figure 2 or 3.
  void add_progress(const char* name, const char* object, const char* scene, const std::vector<int>& iterations) {
    const std::vector<const Job*> jobs = finished_jobs(sweep, scene, "weighted");
    if (jobs.empty()) {
      notes.push_back(fmt::format("{} is left out: no finished job has scene={} and acquisition=weighted, {}", name,
                                  scene, kAllOfThem));
      return;
    }
    const std::string title = fmt::format("{}: surface, and where to tap next", object);
    figures.push_back(
        progress_figure(name, title_with_seed(title, sweep, *jobs.front()), progress(*jobs.front(), iterations)));
  }

  /// Returns whether two jobs differ only in the strategy.
  bool alike(const Job* one, const Job* other) const {
    return std::all_of(sweep.keys.begin(), sweep.keys.end(), [&](const std::string& key) {
      return key == "acquisition" || value_of(sweep, *one, key) == value_of(sweep, *other, key);
    });
  }

  /// Adds figures 4 and 5, which compare two jobs that differ only in the strategy.
  void add_comparisons() {
    const auto uncertainty_jobs = finished_jobs(sweep, "object_i_right", "uncertainty");
    const auto weighted_jobs = finished_jobs(sweep, "object_i_right", "weighted");
    for (const Job* const uncertainty_job : uncertainty_jobs) {
      const auto weighted_job = std::find_if(weighted_jobs.begin(), weighted_jobs.end(),
                                             [&](const Job* job) { return alike(uncertainty_job, job); });
      if (weighted_job != weighted_jobs.end()) return add_comparison(*uncertainty_job, **weighted_job);
    }
    const char* const missing =
        uncertainty_jobs.empty() ? "no finished job has scene=object_i_right and acquisition=uncertainty"
        : weighted_jobs.empty()  ? "no finished job has scene=object_i_right and acquisition=weighted"
                                 : "no two finished jobs with scene=object_i_right, one with "
                                   "acquisition=uncertainty and one with weighted, are equal in all else";
    notes.push_back(fmt::format("figure_4 and figure_5 are left out: {}, {}", missing, kAllOfThem));
  }

  void add_comparison(const Job& uncertainty_job, const Job& weighted_job) {
    const RunSnapshots above = progress(uncertainty_job, {1, 10, 16});
    const RunSnapshots below = progress(weighted_job, {1, 10, 16});
    const auto add = [&](const char* name, const char* what, Eigen::VectorXd MapsAtTap::*map) {
      const std::string title = fmt::format("Object I on the right: {}", what);
      figures.push_back(
          panels_figure(name, title_with_seed(title, sweep, uncertainty_job), {{above, map}, {below, map}}));
    };
    add("figure_4", "where to tap next", &MapsAtTap::scores);
    add("figure_5", "uncertainty", &MapsAtTap::uncertainty);
  }
};

}  // namespace

Figures write_paper_figures(const RunEnvironment& environment, const RecordedRun& recording,
                            const std::filesystem::path& folder) {
  const RunSnapshots progress = progress_of(environment, recording, {1, 8, 10, 14});
  return {write_figures(folder, {progress_figure("paper_progress", recording.config.options.name, progress)}), {}};
}

Figures write_paper_figures(const RunEnvironment& environment, const Sweep& sweep,
                            const std::filesystem::path& folder) {
  PaperFigures out(environment, sweep);
  out.add_progress("figure_2", "Object I", "object_i", {1, 8, 10, 14});
  out.add_progress("figure_3", "Object II", "object_ii", {1, 6, 12, 17});
  out.add_comparisons();
  if (out.figures.empty())
    throw Error(sweep.directory.string(),
                "has no finished job with scene=object_i, object_ii or object_i_right and the strategy of one of the "
                "paper's figures",
                kAllOfThem);
  return {write_figures(folder, out.figures), out.notes};
}

}  // namespace palpate

// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"
#include "report/figures/gallery.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace palpate {
namespace {

constexpr double kLeft = 70;    // of the first panel: room for an axis
constexpr double kRight = 150;  // of the last one: room for a scale
constexpr double kMap = 225;    // longer side of a map, pixels
constexpr double kStep = 312;   // from panel to panel
constexpr double kHead = 48;    // for the title
constexpr double kSurface = 200;

int taps_at(int iteration, int initial, int all) {
  // The paper's iteration 1 is the state that its first chosen tap comes from, with the initial taps alone.
  return std::clamp(iteration + initial - 1, 1, all);
}

std::string iteration_words(int iteration, const Snapshot& snapshot) {
  return fmt::format("iteration {}, after tap {}\n{}", iteration, snapshot.taps, count_words(snapshot));
}

/// The least and the largest value of a map over the snapshots of a run.
template <class Pick>
std::pair<double, double> extent(const Progress& run, const Pick& pick) {
  std::pair<double, double> out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Snapshot& one : run.snapshots)
    out = {std::min(out.first, pick(one).minCoeff()), std::max(out.second, pick(one).maxCoeff())};
  return out;
}

Colours colours_of(const PanelRow& row) {
  if (row.kind == PanelRow::Kind::uncertainty) return {Palette::cividis, 0.0, 1.0, "u"};
  if (row.kind == PanelRow::Kind::surface) {
    const auto [least, most] = extent(
        row.run, [](const Snapshot& one) -> const auto& { return one.deviation; });
    return deviation_colours(least, most);
  }
  // From 0, where nobody would tap.
  const double high = extent(
                          row.run, [](const Snapshot& one) -> const auto& { return one.scores; })
                          .second;
  return {Palette::viridis, 0.0, high > 0.0 ? high : 1.0, fmt::format("score ({})", row.run.strategy)};
}

/// "" where no score is below 0.
std::string below_zero_words(const std::vector<PanelRow>& rows) {
  double least = 0.0;
  for (const PanelRow& row : rows) {
    if (row.kind != PanelRow::Kind::scores) continue;
    least = std::min(least, extent(
                                row.run, [](const Snapshot& one) -> const auto& { return one.scores; })
                                .first);
  }
  return least < -0.005 ? fmt::format("scores below 0, to {:.2f}, have the colour of 0", least) : "";
}

/// The name of a panel in those of its blocks, for which gnuplot takes letters, digits and '_'.
std::string key_of(const Progress& progress, std::size_t column) {
  std::string out = fmt::format("{}_{}", progress.strategy, progress.iterations[column]);
  const std::string allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  for (char& c : out) c = allowed.find(c) == std::string::npos ? '_' : c;
  return out;
}

double height_of(const PanelRow& row, const Box& map) {
  return row.kind == PanelRow::Kind::surface ? kSurface : map.height;
}

/// The panels of a row below `top`, and the scale of their colours; `map` is the box of the first map.
void draw_row(Sheet& sheet, const PanelRow& row, double top, const Box& map) {
  const Progress& run = row.run;
  const Raster raster(run.candidates, run.area);
  const Colours colours = colours_of(row);
  const Relief relief = relief_of(run.snapshots, run.candidates.points, run.area, run.desk);
  double left = map.left;
  for (std::size_t i = 0; i < run.snapshots.size(); ++i, left += kStep) {
    const Snapshot& snapshot = run.snapshots[i];
    const std::string key = key_of(run, i);
    if (row.kind == PanelRow::Kind::surface) {
      sheet.data("surface_" + key, raster.surface(snapshot.surface, snapshot.deviation));
      Snapshot seen = in_sight(snapshot, run.candidates, run.area);
      seen.next.reset();  // it stands in the map
      sheet.taps("seen_" + key, seen);
      sheet.surface({left - 4, top, map.width + 26, kSurface}, raster, "surface_" + key, "seen_" + key, colours,
                    relief);
    } else {
      const bool of_scores = row.kind == PanelRow::Kind::scores;
      const std::string block = (of_scores ? "scores_" : "u_") + key;
      sheet.data(block, raster.matrix(of_scores ? snapshot.scores : snapshot.uncertainty));
      sheet.taps(key, snapshot);
      sheet.map({left, top, map.width, map.height}, raster, block, key, colours);
    }
  }
  const double gap = row.kind == PanelRow::Kind::surface ? 48 : 22;  // the axis of heights stands out
  sheet.bar({left - kStep + map.width + gap, top, 14, height_of(row, map)}, colours);
}

}  // namespace

Progress progress_of(const Workshop& workshop, const Recording& recording, const std::vector<int>& iterations) {
  const ExperimentOptions& options = recording.config.options;
  const int all = static_cast<int>(recording.taps.size());
  const auto initial = static_cast<int>(std::count_if(
      recording.taps.begin(), recording.taps.end(), [](const PastTap& tap) { return tap.source == Source::initial; }));
  Playback playback(workshop, recording);
  std::vector<int> shown;
  std::vector<int> taps;
  for (const int one : iterations) {
    const int at = taps_at(one, initial, all);
    if (!taps.empty() && at == taps.back()) break;  // beyond the end there is but one last tap
    shown.push_back(one);
    taps.push_back(at);
  }
  Progress out{options.acquisition.type, shown, snapshots_at(playback, recording, taps), {}, {}, 0.0};
  out.candidates = playback.experiment().candidates();
  out.area = playback.experiment().scene().area();
  out.desk = playback.experiment().scene().desk();
  return out;
}

Figure panels_figure(const std::string& name, const std::string& title, const std::vector<PanelRow>& rows) {
  constexpr double kWords = 60;  // above the first row of a run
  constexpr double kBelow = 54;  // a row
  const std::size_t columns = rows.front().run.snapshots.size();
  const bool several = &rows.front().run != &rows.back().run;
  const Box map = map_box(rows.front().run.area, several ? kLeft + 24 : kLeft, 0, kMap);
  const auto begins_run = [&](std::size_t row) { return row == 0 || &rows[row].run != &rows[row - 1].run; };
  std::vector<double> tops;
  double bottom = kHead;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    tops.push_back(bottom + (begins_run(i) ? kWords : 0.0));
    bottom = tops.back() + height_of(rows[i], map) + kBelow;
  }
  Sheet sheet(static_cast<int>(map.left + kStep * static_cast<double>(columns - 1) + kMap + kRight),
              static_cast<int>(bottom + 40));
  sheet.text(title, map.left, 14, 15);
  bool failed = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Progress& run = rows[i].run;
    for (std::size_t k = 0; begins_run(i) && k < columns; ++k) {
      failed = failed || run.snapshots[k].failed > 0;
      sheet.text(iteration_words(run.iterations[k], run.snapshots[k]),
                 map.left + kStep * static_cast<double>(k) + 0.5 * map.width, tops[i] - 52, 11, Sheet::Align::centre);
    }
    if (several) sheet.upright(run.strategy, 22, tops[i] + 0.5 * height_of(rows[i], map), 14);
    draw_row(sheet, rows[i], tops[i], map);
  }
  if (const std::string words = below_zero_words(rows); !words.empty()) sheet.text(words, 680, bottom + 6, 10);
  sheet.legend(map.left + 6, bottom + 14, failed);
  return {name, std::move(sheet)};
}

Figure progress_figure(const std::string& name, const std::string& title, const Progress& progress) {
  return panels_figure(name, title, {{progress, PanelRow::Kind::surface}, {progress, PanelRow::Kind::scores}});
}

namespace {

/// The jobs of a sweep, found by the values of its swept keys.
class JobFinder {
 public:
  explicit JobFinder(const Sweep& sweep) : sweep_(sweep) {}

  /// Those of this scene and strategy that ended well, in the order of the sweep.
  std::vector<const Job*> jobs(const std::string& scene, const std::string& acquisition) const {
    std::vector<const Job*> out;
    for (const Job& job : sweep_.jobs) {
      if (value(job, "scene") != scene || value(job, "acquisition") != acquisition) continue;
      if (read_ending(job_directory(sweep_, job)).state == RunStatus::State::done) out.push_back(&job);
    }
    return out;
  }

  /// Whether two jobs have the same values of all keys but the strategy.
  bool alike(const Job& a, const Job& b) const {
    for (std::size_t i = 0; i < sweep_.keys.size(); ++i) {
      if (sweep_.keys[i] != "acquisition" && a.values[i] != b.values[i]) return false;
    }
    return true;
  }

  /// "seed 3"; "" where no seed is swept.
  std::string seed_words(const Job& job) const {
    const std::string seed = value(job, "seed");
    return seed.empty() ? "" : ", seed " + seed;
  }

 private:
  std::string value(const Job& job, const std::string& key) const {
    const auto found = std::find(sweep_.keys.begin(), sweep_.keys.end(), key);
    return found != sweep_.keys.end() ? job.values[static_cast<std::size_t>(found - sweep_.keys.begin())] : "";
  }

  const Sweep& sweep_;
};

constexpr const char* kAllOfThem = "configs/paper/figures.yaml has them all";

void add_progress(const Workshop& workshop, const Sweep& sweep, const std::string& name, const std::string& object,
                  const std::string& scene, const std::vector<int>& iterations, std::vector<Figure>& figures,
                  std::vector<std::string>& notes) {
  const JobFinder finder(sweep);
  const std::vector<const Job*> jobs = finder.jobs(scene, "weighted");
  if (jobs.empty()) {
    notes.push_back(fmt::format("{} is left out: no finished job has scene={} and acquisition=weighted, {}", name,
                                scene, kAllOfThem));
    return;
  }
  const Recording recording = read_recording(workshop, job_directory(sweep, *jobs.front()));
  const Progress progress = progress_of(workshop, recording, iterations);
  figures.push_back(progress_figure(
      name, fmt::format("{}: surface, and where to tap next{}", object, finder.seed_words(*jobs.front())), progress));
}

}  // namespace

std::vector<Figure> paper_figures(const Workshop& workshop, const Sweep& sweep, std::vector<std::string>& notes) {
  std::vector<Figure> figures;
  add_progress(workshop, sweep, "figure_2", "Object I", "object_i", {1, 8, 10, 14}, figures, notes);
  add_progress(workshop, sweep, "figure_3", "Object II", "object_ii", {1, 6, 12, 17}, figures, notes);
  const JobFinder finder(sweep);
  const auto rivals = finder.jobs("object_i_right", "uncertainty");
  const auto explorers = finder.jobs("object_i_right", "weighted");
  for (const Job* rival : rivals) {
    const auto partner =
        std::find_if(explorers.begin(), explorers.end(), [&](const Job* one) { return finder.alike(*rival, *one); });
    if (partner == explorers.end()) continue;
    const auto progress = [&](const Job& job) {
      return progress_of(workshop, read_recording(workshop, job_directory(sweep, job)), {1, 10, 16});
    };
    const Progress above = progress(*rival);
    const Progress below = progress(**partner);
    const auto add = [&](const char* name, const char* what, PanelRow::Kind kind) {
      const std::string title = fmt::format("Object I on the right: {}{}", what, finder.seed_words(*rival));
      figures.push_back(panels_figure(name, title, {{above, kind}, {below, kind}}));
    };
    add("figure_4", "where to tap next", PanelRow::Kind::scores);
    add("figure_5", "uncertainty", PanelRow::Kind::uncertainty);
    break;
  }
  if (figures.empty() || figures.back().name != "figure_5") {
    const char* const missing = rivals.empty() ? "no finished job has scene=object_i_right and acquisition=uncertainty"
                                : explorers.empty()
                                    ? "no finished job has scene=object_i_right and acquisition=weighted"
                                    : "no two finished jobs with scene=object_i_right, one with "
                                      "acquisition=uncertainty and one with weighted, are equal in all else";
    notes.push_back(fmt::format("figure_4 and figure_5 are left out: {}, {}", missing, kAllOfThem));
  }
  if (figures.empty()) {
    throw Error(sweep.directory.string(),
                "has no finished job with scene=object_i, object_ii or object_i_right and the strategy of one of the "
                "paper's figures",
                kAllOfThem);
  }
  return figures;
}

}  // namespace palpate

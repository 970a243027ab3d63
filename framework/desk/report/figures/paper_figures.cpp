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
constexpr double kRight = 120;  // of the last one: room for a scale
constexpr double kMap = 225;    // longer side of a map, pixels
constexpr double kStep = 312;   // from panel to panel
constexpr double kHead = 48;    // for the title

int taps_at(int iteration, int initial, int all) {
  // The paper's iteration 1 is the state that its first chosen tap comes from, with the initial taps alone.
  return std::clamp(iteration + initial - 1, 1, all);
}

std::string iteration_words(int iteration, const Snapshot& snapshot) {
  return fmt::format("iteration {}, after tap {}\n{}", iteration, snapshot.taps, count_words(snapshot));
}

/// The largest value of a map over some snapshots, at least `least`.
template <class Pick>
double largest(const std::vector<Snapshot>& snapshots, double least, const Pick& pick) {
  for (const Snapshot& one : snapshots) least = std::max(least, pick(one).maxCoeff());
  return least;
}

/// Colours for the scores of a run: from 0, where nobody would tap.
Colours score_colours(const Progress& progress) {
  const double high = largest(
      progress.snapshots, 0.0, [](const Snapshot& m) -> const auto& { return m.scores; });
  return {Palette::viridis, 0.0, high > 0.0 ? high : 1.0, fmt::format("score ({})", progress.strategy)};
}

double least_score(const std::vector<Progress>& rows) {
  double least = 0.0;
  for (const Progress& row : rows) {
    for (const Snapshot& one : row.snapshots) least = std::min(least, one.scores.minCoeff());
  }
  return least;
}

std::string below_zero_words(double least) {
  return least < -0.005 ? fmt::format("scores below 0, to {:.2f}, have the colour of 0", least) : "";
}

bool any_failed(const std::vector<Snapshot>& snapshots) {
  return std::any_of(snapshots.begin(), snapshots.end(), [](const Snapshot& one) { return one.failed > 0; });
}

int sheet_width(std::size_t columns) {
  return static_cast<int>(kLeft + kStep * static_cast<double>(columns - 1) + kMap + kRight);
}

/// The name of a panel in those of its blocks, for which gnuplot takes letters, digits and '_'.
std::string key_of(const Progress& progress, std::size_t column) {
  std::string out = fmt::format("{}_{}", progress.strategy, progress.iterations[column]);
  const std::string allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  for (char& c : out) c = allowed.find(c) == std::string::npos ? '_' : c;
  return out;
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

Figure progress_figure(const std::string& name, const std::string& title, const Progress& progress) {
  constexpr double kSurface = 200;
  constexpr double kWords = 56;
  const std::size_t columns = progress.snapshots.size();
  const Box first = map_box(progress.area, kLeft, kHead + kWords + kSurface + 58, kMap);
  Sheet sheet(sheet_width(columns) + 30, static_cast<int>(first.top + first.height + 88));
  const Raster raster(progress.candidates, progress.area);
  const auto deviation = [](const Snapshot& m) -> const auto& { return m.deviation; };
  double least = std::numeric_limits<double>::infinity();
  for (const Snapshot& one : progress.snapshots) least = std::min(least, one.deviation.minCoeff());
  const Colours doubt = deviation_colours(least, largest(progress.snapshots, 0.0, deviation));
  const Colours scores = score_colours(progress);
  const Relief relief = relief_of(progress.snapshots, progress.candidates.points, progress.area, progress.desk);
  sheet.text(title, kLeft, 14, 15);
  for (std::size_t i = 0; i < columns; ++i) {
    const Snapshot& snapshot = progress.snapshots[i];
    const std::string key = key_of(progress, i);
    sheet.data("surface_" + key, raster.surface(snapshot.surface, snapshot.deviation));
    sheet.data("scores_" + key, raster.matrix(snapshot.scores));
    sheet.taps(key, snapshot);
    Snapshot seen = in_sight(snapshot, progress.candidates, progress.area);
    seen.next.reset();  // it stands in the map
    sheet.taps("seen_" + key, seen);
  }
  for (std::size_t i = 0; i < columns; ++i) {
    const std::string key = key_of(progress, i);
    const double left = kLeft + kStep * static_cast<double>(i);
    sheet.text(iteration_words(progress.iterations[i], progress.snapshots[i]), left + 0.5 * first.width, kHead, 11,
               Sheet::Align::centre);
    sheet.surface({left - 4, kHead + kWords, first.width + 26, kSurface}, raster, "surface_" + key, "seen_" + key,
                  doubt, relief);
    sheet.map({left, first.top, first.width, first.height}, raster, "scores_" + key, key, scores);
  }
  const double right = kLeft + kStep * static_cast<double>(columns - 1) + first.width + 22;
  sheet.bar({right + 26, kHead + kWords + 10, 14, kSurface - 20}, doubt);
  sheet.bar({right, first.top, 14, first.height}, scores);
  const double bottom = first.top + first.height + 64;
  const std::string words = below_zero_words(least_score({progress}));
  if (!words.empty()) sheet.text(words, 680, bottom - 8, 10);
  sheet.legend(kLeft + 6, bottom, any_failed(progress.snapshots));
  return {name, std::move(sheet)};
}

Figure comparison_figure(const std::string& name, const std::string& title, const std::vector<Progress>& rows,
                         ComparedMap map) {
  constexpr double kWords = 62;
  const std::size_t columns = rows.front().snapshots.size();
  const Area area = rows.front().area;
  const Box first = map_box(area, kLeft + 24, kHead + kWords, kMap);
  const double row_step = first.height + kWords + 48;
  const double bottom = kHead + row_step * static_cast<double>(rows.size()) + 12;
  Sheet sheet(sheet_width(columns) + 24, static_cast<int>(bottom + 28));
  const bool of_scores = map == ComparedMap::scores;
  sheet.text(title, kLeft + 24, 14, 15);
  const std::string prefix = of_scores ? "scores_" : "u_";
  for (const Progress& row : rows) {
    const Raster raster(row.candidates, area);
    for (std::size_t i = 0; i < columns; ++i) {
      sheet.data(prefix + key_of(row, i),
                 raster.matrix(of_scores ? row.snapshots[i].scores : row.snapshots[i].uncertainty));
      sheet.taps(key_of(row, i), row.snapshots[i]);
    }
  }
  bool failed = false;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Progress& row = rows[r];
    const Raster raster(row.candidates, area);
    const double top = first.top + row_step * static_cast<double>(r);
    const Colours colours = of_scores ? score_colours(row) : Colours{Palette::cividis, 0.0, 1.0, "u"};
    for (std::size_t i = 0; i < columns; ++i) {
      const double left = first.left + kStep * static_cast<double>(i);
      sheet.text(iteration_words(row.iterations[i], row.snapshots[i]), left + 0.5 * first.width, top - 48, 11,
                 Sheet::Align::centre);
      sheet.map({left, top, first.width, first.height}, raster, prefix + key_of(row, i), key_of(row, i), colours);
    }
    sheet.upright(row.strategy, 22, top + 0.5 * first.height, 14);
    sheet.bar({first.left + kStep * static_cast<double>(columns - 1) + first.width + 22, top, 14, first.height},
              colours);
    failed = failed || any_failed(row.snapshots);
  }
  const std::string words = of_scores ? below_zero_words(least_score(rows)) : "";
  if (!words.empty()) sheet.text(words, 680, bottom - 8, 10);
  sheet.legend(first.left + 6, bottom, failed);
  return {name, std::move(sheet)};
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
    std::vector<Progress> rows;
    for (const Job* job : {rival, *partner}) {
      const Recording recording = read_recording(workshop, job_directory(sweep, *job));
      rows.push_back(progress_of(workshop, recording, {1, 10, 16}));
    }
    const std::string seed = finder.seed_words(*rival);
    figures.push_back(
        comparison_figure("figure_4", "Object I on the right: where to tap next" + seed, rows, ComparedMap::scores));
    figures.push_back(
        comparison_figure("figure_5", "Object I on the right: uncertainty" + seed, rows, ComparedMap::uncertainty));
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

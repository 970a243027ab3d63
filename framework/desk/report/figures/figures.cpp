// SPDX-License-Identifier: MIT
#include "report/figures/figures.hpp"

#include "analysis/column.hpp"
#include "analysis/gnuplot.hpp"
#include "record/files.hpp"
#include "report/figures/gallery.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

std::vector<fs::path> write_gallery(const fs::path& folder, const std::vector<Figure>& figures) {
  make_inner_folder(folder);
  std::error_code failed;
  for (const auto& [name, sheet] : figures) {
    // An older picture would be that of another script.
    fs::remove(folder / (name + ".png"), failed);
    write_file(folder / (name + ".gnuplot"), png_header(sheet.width(), sheet.height(), name + ".png") + sheet.script());
  }
  std::vector<fs::path> pictures;
  for (const auto& [name, sheet] : figures) {
    pictures.push_back(folder / (name + ".png"));
    const std::string trouble = draw_png(sheet.script(), sheet.width(), sheet.height(), pictures.back());
    if (trouble.empty()) continue;
    throw Error(pictures.back().string(), "was not drawn: " + trouble,
                fmt::format("'gnuplot {}.gnuplot' in that folder draws it later", name), Error::Kind::run);
  }
  return pictures;
}

Figures write_run_figures(const Workshop& workshop, const Recording& recording, const History& history) {
  Playback playback(workshop, recording);
  const Snapshot last = snapshots_at(playback, recording, {static_cast<int>(recording.taps.size())}).front();
  const Ground ground = ground_of(playback.experiment());
  const ExperimentOptions& options = recording.config.options;
  return {write_gallery(recording.directory / "figures",
                        {surface_figure(options, ground, last), maps_figure(options, ground, last),
                         curves_figure(recording, history)}),
          {}};
}

Figures write_sweep_figures(const Sweep& sweep) {
  const std::vector<Row> results = sweep_results(sweep);
  if (std::none_of(results.begin(), results.end(), is_done))
    throw Error(sweep.directory.string(), "has no job that ended well", {}, Error::Kind::run);
  std::vector<Figure> figures{distributions_figure(sweep, results)};
  for (Figure& one : heat_maps(sweep, results)) figures.push_back(std::move(one));
  return {write_gallery(sweep.directory / "figures", figures), {}};
}

Figures write_paper_figures(const Workshop& workshop, const Recording& recording) {
  const Progress progress = progress_of(workshop, recording, {1, 8, 10, 14});
  return {write_gallery(recording.directory / "figures",
                        {progress_figure("paper_progress", recording.config.options.name, progress)}),
          {}};
}

Figures write_paper_figures(const Workshop& workshop, const Sweep& sweep) {
  Figures out;
  const std::vector<Figure> figures = paper_figures(workshop, sweep, out.notes);
  out.pictures = write_gallery(sweep.directory / "figures", figures);
  return out;
}

}  // namespace palpate

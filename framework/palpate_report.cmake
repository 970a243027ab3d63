# SPDX-License-Identifier: MIT
# palpate_report: evaluation of runs and sweeps: statistics, tables, pages, figures, texts.
add_library(palpate_report STATIC
  analysis/statistics.cpp analysis/bootstrap.cpp analysis/signed_rank.cpp analysis/column.cpp analysis/groups.cpp analysis/mean_output.cpp analysis/table.cpp
  analysis/sweep_table.cpp analysis/runs_table.cpp analysis/pareto.cpp analysis/pareto_report.cpp analysis/compare.cpp analysis/compare_plan.cpp
  analysis/compare_report.cpp analysis/means_table.cpp analysis/group_curves.cpp analysis/group_curves_report.cpp
  analysis/gnuplot.cpp analysis/importance.cpp
  tune/description.cpp tune/search_space.cpp tune/elimination.cpp tune/race.cpp tune/planner.cpp tune/tuner.cpp
  tune/race_report.cpp
  bundle/archive.cpp bundle/bundle.cpp bundle/repeat.cpp
  calibrate/contact_fit.cpp calibrate/simulated_rerun.cpp calibrate/calibrate.cpp
  report/contours.cpp report/history.cpp report/curves.cpp report/colours.cpp
  report/page/assets.S report/page/page.cpp
  report/page/warnings.cpp report/page/run_page.cpp report/page/runs_page.cpp
  report/page/sweep_page.cpp report/page/sweep_race.cpp report/page/sweep_curves.cpp
  report/figures/figure_layout.cpp report/figures/paper_figures.cpp report/figures/curves_legend.cpp report/figures/curves_figure.cpp
  report/figures/run_figures.cpp report/figures/sweep_figures.cpp
  report/words/words.cpp report/words/titles.cpp report/words/models.cpp report/words/explanation.cpp report/words/explain.cpp report/words/explain_any_side.cpp
  report/mesh_export.cpp
  watch/growing_log.cpp watch/run_follower.cpp watch/sweep_follower.cpp watch/site.cpp watch/server.cpp)
target_include_directories(palpate_report PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(palpate_report PUBLIC palpate_sweep PRIVATE palpate_warnings Boost::headers Threads::Threads ${ZLIB} PkgConfig::NETTLE nlohmann_json::nlohmann_json)
target_precompile_headers(palpate_report REUSE_FROM palpate_sweep)
target_compile_options(palpate_report PRIVATE ${quick_to_build})
# Resampling takes most of the time of an interval.
set_source_files_properties(analysis/bootstrap.cpp PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O3> SKIP_PRECOMPILE_HEADERS ON)
# The iterators of base64 are fast only if they are inlined.
set_source_files_properties(report/page/page.cpp PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O3> SKIP_PRECOMPILE_HEADERS ON)
# Only server.cpp includes Boost.Beast.
palpate_in_batches(palpate_report watch/server.cpp)
# The assembler includes these files; CMake does not see such dependencies.
set(report_files vendor/plotly/plotly.min.js.gz web/style.css web/theme.js web/common.js web/live.js web/run_maps.js web/run_space.js web/play.js
                 web/run.js web/runs.js
                 web/sweep_numbers.js web/sweep_panels.js web/sweep_curves.js web/sweep_race.js web/sweep.js)
list(TRANSFORM report_files PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/report/page/)
list(APPEND report_files ${CMAKE_CURRENT_SOURCE_DIR}/analysis/figure_templates.gnuplot)
set_source_files_properties(report/page/assets.S PROPERTIES OBJECT_DEPENDS "${report_files}"
                            COMPILE_OPTIONS "-I${CMAKE_CURRENT_SOURCE_DIR}/report/page;-I${CMAKE_CURRENT_SOURCE_DIR}/analysis" SKIP_PRECOMPILE_HEADERS ON)

# SPDX-License-Identifier: MIT
# palpate_sweep: many runs from one config, and the launchers that run them.
# The table of launchers, in the order of `--launcher`; the first one is the default. launch/NAME_launcher.cpp has NAME.
# Jobs of a launcher that is marked `cluster` continue without the process that launched them.
set(launchers
  local
  slurm:cluster)
foreach(launcher ${launchers})
  string(REGEX REPLACE ":cluster$" "" name ${launcher})
  list(APPEND launcher_files launch/${name}_launcher.cpp)
  string(COMPARE NOTEQUAL ${launcher} ${name} is_cluster)
  string(APPEND launcher_table "PALPATE_LAUNCHER(${name}, ${is_cluster})\n")
endforeach()
file(CONFIGURE OUTPUT launch/launcher_table.inc CONTENT "${launcher_table}")

add_library(palpate_sweep STATIC
  sweep/where_condition.cpp sweep/sobol.cpp sweep/description.cpp sweep/planner.cpp sweep/plan.cpp sweep/draft.cpp
  sweep/sweep.cpp sweep/pooled_sweep.cpp sweep/pooled_keys.cpp sweep/pooled_values.cpp sweep/results_after_taps.cpp sweep/tap_summaries.cpp
  launch/job.cpp launch/execute_jobs.cpp launch/parallel_children.cpp launch/slurm.cpp launch/mounts.cpp
  launch/launcher_table.cpp ${launcher_files})
target_include_directories(palpate_sweep PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR})
target_link_libraries(palpate_sweep PUBLIC palpate_core PRIVATE palpate_warnings Boost::headers)
# Other targets with the same compiler flags reuse this precompiled header.
target_precompile_headers(palpate_sweep PRIVATE <Eigen/Core> <algorithm> <filesystem> <fmt/format.h> <functional>
                                                <memory> <optional> <string> <vector>)
target_compile_options(palpate_sweep PRIVATE ${quick_to_build})
palpate_in_batches(palpate_sweep)

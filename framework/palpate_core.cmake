# SPDX-License-Identifier: MIT
# palpate_core: from a config to the record of its run.
set(gp gp/candidate_grid.cpp gp/factor.cpp gp/posterior_maps.cpp gp/gaussian_process.cpp gp/engine.cpp gp/map_tiles.cpp gp/workers.cpp gp/axis_basis.cpp gp/engine_dense.cpp gp/engine_grid.cpp gp/engine_lowrank.cpp)
# Gaussian processes over the candidates. The belief `solids` links them, too, so that their symbols are hidden.
add_library(palpate_gp STATIC ${gp} gp/outlier_posterior.cpp gp/outlier_search.cpp gp/robust_surface.cpp gp/offset_model.cpp gp/vector_loops.cpp)
target_include_directories(palpate_gp PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(palpate_gp PUBLIC palpate::plugin_api palpate_regular fmt::fmt Threads::Threads
                                 PRIVATE palpate_warnings palpate_highway)
set_target_properties(palpate_gp PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
add_library(palpate_core STATIC
  config/tree.cpp config/yaml.cpp config/yaml_writer.cpp config/quantity.cpp config/display_units.cpp config/override.cpp config/group_files.cpp config/compose.cpp config/map_reader.cpp config/resolve.cpp config/describe.cpp
  config/hash.cpp config/expand.cpp config/keys.cpp config/comparison.cpp
  host/plugin_host.cpp host/loaded_hash.cpp host/plugin_calls.cpp host/listing.cpp
  scene/scene_options.cpp scene/effect_options.cpp scene/scene.cpp scene/size_warnings.cpp scene/body.cpp scene/placement.cpp scene/random_objects.cpp
  belief/point_cloud.cpp belief/camera_view.cpp
  experiment/experiment_options.cpp record/resolved_config.cpp
  belief/builtin_plugins.cpp belief/height_map.cpp belief/height_map_options.cpp belief/height_map_models.cpp belief/contact_log.cpp belief/contact_reader.cpp belief/gp_model.cpp belief/footprint_model.cpp
  belief/outlier_model.cpp belief/height_model.cpp belief/surface_model.cpp experiment/initial_design.cpp experiment/pick_best.cpp experiment/search_design.cpp belief/expected_rmse.cpp belief/metrics.cpp belief/object_errors.cpp
  experiment/check_quantities.cpp experiment/stop_rules.cpp experiment/tap_selector.cpp experiment/motion_selector.cpp experiment/run_monitor.cpp experiment/experiment.cpp
  record/row.cpp record/json.cpp record/files.cpp record/record_reader.cpp record/record_writer.cpp record/run_directory.cpp record/catalogue.cpp record/distinguishing_settings.cpp
  record/build_info.cpp record/fields.cpp record/expectation.cpp record/mesh_ply.cpp record/stopwatch.cpp record/surface_files.cpp
  record/recorded_run.cpp record/run.cpp record/evaluation_point.cpp record/run_replay.cpp
  record/quantiles.cpp record/gate.cpp)
target_include_directories(palpate_core PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_include_directories(palpate_core SYSTEM PRIVATE ${XXHASH_INCLUDE_DIR})
target_link_libraries(palpate_core
  PUBLIC palpate_gp palpate::plugin_api palpate_answers palpate_children palpate_reading palpate_regular fmt::fmt Threads::Threads
  PRIVATE palpate_warnings palpate_highway Boost::headers ${YAML_CPP} nlohmann_json::nlohmann_json ${CMAKE_DL_LIBS})
# What names the build in manifests. Not the linker's hash of a program: there are two that have core, and a word that a
# command says would make every finished run one of another build.
set(core_hash ${CMAKE_CURRENT_BINARY_DIR}/core_hash.cpp)
set(archives ${YAML_CPP})
list(FILTER archives INCLUDE REGEX "\\.a$")
add_custom_command(OUTPUT ${core_hash}
  COMMAND ${CMAKE_COMMAND} "-DFILES=$<TARGET_OBJECTS:palpate_core>;$<TARGET_OBJECTS:palpate_gp>;$<TARGET_OBJECTS:palpate_answers>;$<TARGET_OBJECTS:palpate_children>;$<TARGET_OBJECTS:palpate_reading>;$<TARGET_OBJECTS:palpate_regular>;$<TARGET_OBJECTS:palpate_math>;${archives}" -DOUTPUT=${core_hash}
          "-DFLAGS=${CMAKE_CXX_FLAGS} ${CMAKE_EXE_LINKER_FLAGS}" -P ${PROJECT_SOURCE_DIR}/framework/cmake/CoreHash.cmake
  DEPENDS $<TARGET_OBJECTS:palpate_core> $<TARGET_OBJECTS:palpate_gp> $<TARGET_OBJECTS:palpate_answers> $<TARGET_OBJECTS:palpate_children> $<TARGET_OBJECTS:palpate_reading> $<TARGET_OBJECTS:palpate_regular> $<TARGET_OBJECTS:palpate_math> ${PROJECT_SOURCE_DIR}/framework/cmake/CoreHash.cmake
  COMMENT "" VERBATIM)
add_library(palpate_core_hash STATIC ${core_hash})
# By its file: whoever is only compiled with core need not wait until all of core is.
target_link_libraries(palpate_core INTERFACE $<TARGET_FILE:palpate_core_hash>)
# A quarter of the time of a file's compilation would go into these.
target_precompile_headers(palpate_core PRIVATE <Eigen/Core> <algorithm> <filesystem> <fmt/format.h> <functional>
                                               <memory> <optional> <string> <vector>)
target_precompile_headers(palpate_gp PRIVATE <Eigen/Core> <algorithm> <memory> <optional> <string> <vector>)
set(alone record/fields.cpp)
set(gp_alone gp/vector_loops.cpp)
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  # The code in gp is what takes time in a run: how fast it is shall not hang on its neighbours.
  list(APPEND gp_alone ${gp})
  list(APPEND alone record/json.cpp)
endif()
palpate_in_batches(palpate_core ${alone})
palpate_in_batches(palpate_gp ${gp_alone})
set_source_files_properties(host/plugin_host.cpp PROPERTIES COMPILE_DEFINITIONS BOOST_DLL_USE_STD_FS)
set_source_files_properties(record/build_info.cpp PROPERTIES COMPILE_DEFINITIONS
  "PALPATE_VERSION=\"${PROJECT_VERSION}\";PALPATE_YAML_CPP_VERSION=\"${yaml-cpp_VERSION}\";PALPATE_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\"")

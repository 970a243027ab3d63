# SPDX-License-Identifier: MIT
# Used by find_package(palpate): finds Eigen, and defines palpate::plugin_api and palpate_add_plugin().
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/palpateTargets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/PalpatePlugin.cmake)

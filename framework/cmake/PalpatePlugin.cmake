# SPDX-License-Identifier: MIT
# palpate_add_plugin(KIND NAME SOURCE...) builds the plugin KIND/NAME as lib/palpate/KIND/NAME.so in the build folder. With
# PALPATE_PLUGIN_PATH set to lib/palpate, a config can name the plugin.
function(palpate_add_plugin kind name)
  set(target palpate_${kind}_${name})
  add_library(${target} MODULE ${ARGN})
  target_link_libraries(${target} PRIVATE palpate::plugin_api)
  set_target_properties(${target} PROPERTIES
    PREFIX "" SUFFIX ".so" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/palpate/${kind}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

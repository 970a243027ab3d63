# SPDX-License-Identifier: MIT
# Builds the missing parts in the folder `build` before its installation. ./palpate builds only the parts that a command
# needs, and an installation has all.
file(STRINGS ${build}/lib/palpate/plugins.txt files)
list(TRANSFORM files PREPEND lib/palpate/)
list(TRANSFORM files APPEND .so)
foreach(file palpate-whole lib/palpate/build.json ${files})
  if(NOT EXISTS ${build}/${file})
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target palpate_complete COMMAND_ERROR_IS_FATAL ANY)
    break()
  endif()
endforeach()

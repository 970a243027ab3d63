# SPDX-License-Identifier: MIT
# Run by the installation of `build`: an installed palpate has everything, and ./palpate built what was needed so far.
file(STRINGS ${build}/lib/palpate/plugins.txt files)
list(TRANSFORM files PREPEND lib/palpate/)
list(TRANSFORM files APPEND .so)
foreach(file palpate-whole lib/palpate/build.json ${files})
  if(NOT EXISTS ${build}/${file})
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target palpate_complete COMMAND_ERROR_IS_FATAL ANY)
    break()
  endif()
endforeach()

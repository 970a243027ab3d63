# SPDX-License-Identifier: MIT
# Writes the commit, and whether tracked files differ from it, to OUTPUT. Untracked files do not count. Leaves an equal
# file alone.
set(commit "unknown")
set(dirty "null")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse HEAD OUTPUT_VARIABLE found RESULT_VARIABLE failed
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(commit ${found})
    execute_process(COMMAND ${GIT} -C ${SOURCE} status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
    set(dirty "false")
    if(changes)
      set(dirty "true")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "{\"commit\": \"${commit}\", \"dirty\": ${dirty}}\n")

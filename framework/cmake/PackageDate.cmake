# SPDX-License-Identifier: MIT
# cpack reads this file first. It checks for tools without which cpack fails late or writes packages without dependencies.
# It sets the date of the packages to that of the commit, so that the same build gives the same bytes.
foreach(tool_and_package dpkg-shlibdeps:dpkg-dev file:file strip:binutils gzip:gzip)
  string(REPLACE ":" ";" pair ${tool_and_package})
  list(GET pair 0 tool)
  list(GET pair 1 package)
  find_program(PALPATE_TOOL_${tool} ${tool} PATHS ENV PATH NO_DEFAULT_PATH NO_CACHE)
  if(NOT PALPATE_TOOL_${tool})
    message(FATAL_ERROR "cpack needs ${tool}: apt-get install ${package}")
  endif()
endforeach()
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND git -C ${CPACK_PALPATE_SOURCE} log -1 --format=%ct OUTPUT_VARIABLE date ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(date MATCHES "^[0-9]+$")
    set(ENV{SOURCE_DATE_EPOCH} ${date})
  endif()
endif()

# SPDX-License-Identifier: MIT
# Read by cpack before it begins: what is packed is of the day of its commit, so that the same build gives the same bytes.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND git -C ${CPACK_PALPATE_SOURCE} log -1 --format=%ct OUTPUT_VARIABLE date ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(date MATCHES "^[0-9]+$")
    set(ENV{SOURCE_DATE_EPOCH} ${date})
  endif()
endif()

# SPDX-License-Identifier: MIT
# cpack reads this file after it has installed each package into its folder. It adds the files of Debian's policy, which an
# installation below a prefix does not need, and compresses and strips files.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # that of SOURCE_DATE_EPOCH, if set
file(READ ${CPACK_PALPATE_SOURCE}/LICENSE license)
string(REGEX REPLACE "^MIT License\n\nCopyright \\(c\\) ([^\n]*)\n\n" "" license "${license}")
set(holder ${CMAKE_MATCH_1})
file(STRINGS ${CPACK_PALPATE_SOURCE}/framework/report/page/vendor/plotly/LICENSE plotly REGEX "^Copyright ")
string(REPLACE "Copyright (c) " "" plotly "${plotly}")
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REGEX REPLACE "\n([^\n])" "\n \\1" license "${license}")

function(compress file)
  execute_process(COMMAND gzip -n9 -f ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(name ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(usr ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  set(documents ${usr}/share/doc/${name})

  # dpkg-shlibdeps knows only the packages of this machine's architecture. The packages of other architectures have the
  # same names.
  if(CPACK_PALPATE_CROSS AND NOT component STREQUAL "dev")
    file(MAKE_DIRECTORY ${CPACK_TEMPORARY_DIRECTORY}/${component}/debian)
    execute_process(COMMAND sh -c "cat /var/lib/dpkg/info/*:*.shlibs /var/lib/dpkg/info/*.shlibs | grep -v ':[a-z]'"
                    OUTPUT_FILE ${CPACK_TEMPORARY_DIRECTORY}/${component}/debian/shlibs.local COMMAND_ERROR_IS_FATAL ANY)
  endif()

  file(WRITE ${documents}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: palpate

Files: *
Copyright: ${holder}
License: Expat

Files: framework/report/page/vendor/plotly/*
Copyright: ${plotly}
License: Expat
Comment: plotly.js, which draws the pages of reports and is carried in each.

License: Expat
 ${license}")
  file(WRITE ${documents}/changelog.Debian "palpate (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * What is new: changelog.gz of the package palpate.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  compress(${documents}/changelog.Debian)
  if(component STREQUAL "program")
    file(COPY_FILE ${CPACK_PALPATE_SOURCE}/CHANGELOG.md ${documents}/changelog)
    compress(${documents}/changelog)
  endif()

  file(GLOB pages ${usr}/share/man/man1/*.1)
  foreach(page ${pages})
    compress(${page})
  endforeach()

  # On Debian, packages use vendor-completions. The folder site-functions is for the administrator.
  if(EXISTS ${usr}/share/zsh/site-functions)
    file(RENAME ${usr}/share/zsh/site-functions ${usr}/share/zsh/vendor-completions)
  endif()

  file(GLOB_RECURSE binaries ${usr}/bin/* ${usr}/lib/*.so)
  foreach(binary ${binaries})
    execute_process(COMMAND ${CPACK_PALPATE_STRIP} --strip-unneeded --remove-section=.comment --remove-section=.note
                            ${binary} COMMAND_ERROR_IS_FATAL ANY)
    if(binary MATCHES "\\.so$")
      file(CHMOD ${binary} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
    endif()
  endforeach()
endforeach()

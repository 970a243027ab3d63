# SPDX-License-Identifier: MIT
# Packages for Debian. `cpack -B FOLDER` in a build folder makes palpate, palpate-dev and, if they are built,
# python3-palpate and palpate-baxter. Each component of install() is a package. dpkg-shlibdeps finds the libraries that a
# package depends on. The driver for Baxter has its own package, which keeps ROS out of the others.

# Builds for one type of processor, or with a sanitizer, make no packages.
set(PALPATE_PACKAGES OFF)
if(CMAKE_CXX_FLAGS MATCHES "-march=|-mavx|-fsanitize")
  return()
endif()
set(PALPATE_PACKAGES ON)
set(PALPATE_MAINTAINER "The palpate authors <maintainers@palpate.invalid>" CACHE STRING
    "maintainer of the packages, NAME <MAIL>")
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program dev)
if(TARGET palpate_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(PALPATE_BAXTER)
  list(APPEND CPACK_COMPONENTS_ALL baxter)
endif()

# The version names the Debian of the build, because the libraries differ. The package of a later Debian is newer.
set(distribution "")
if(EXISTS ${CMAKE_SYSROOT}/etc/os-release)
  file(STRINGS ${CMAKE_SYSROOT}/etc/os-release distribution REGEX "^(ID|VERSION_ID)=")
  if(distribution MATCHES "(^|;)ID=debian" AND distribution MATCHES "VERSION_ID=\"?([0-9]+)")
    set(distribution "+deb${CMAKE_MATCH_1}")
  else()
    set(distribution "")
  endif()
endif()
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE "1${distribution}")
set(same_version "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_CONTACT "${PALPATE_MAINTAINER}")
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)  # it has headers only
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/PackageDate.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianFiles.cmake)
set(CPACK_PALPATE_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_PALPATE_STRIP ${CMAKE_STRIP})
set(CPACK_PALPATE_CROSS ${CMAKE_CROSSCOMPILING})
if(CMAKE_CROSSCOMPILING)
  string(REPLACE aarch64 arm64 CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${CMAKE_SYSTEM_PROCESSOR})
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/lib/${CMAKE_LIBRARY_ARCHITECTURE}
                                                  ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()

# debian_package COMPONENT NAME SECTION DESCRIPTION sets the fields of a package. The first line of DESCRIPTION is the
# short description.
macro(debian_package component name section description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${description}")
endmacro()
debian_package(program palpate science "experiments in active touch
A robot arm, or a simulated one, taps an unknown object; Gaussian processes
say where to tap next; after some thirty taps the surface is known. palpate
runs such experiments from YAML files, logs every tap, carries on what was
killed, and compares, reports and exports what came out.
.
Configs are in /usr/share/palpate/configs; `palpate run
configs/paper/object_i.yaml` finds them from any folder.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "palpate-dev, python3-palpate, palpate-baxter, slurm-client")

debian_package(dev palpate-dev libdevel "experiments in active touch - to build plugins with
Headers, a static library of elementary functions, and the CMake package for
plugins of palpate: kernels, acquisitions, fittings, footprints, beliefs, backends and
shapes.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "palpate ${same_version}, libeigen3-dev (>= 3.4), cmake (>= 3.25), ninja-build | make")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS g++)

if(TARGET palpate_python)
  math(EXPR next_minor "${PALPATE_PYTHON_MINOR} + 1")
  debian_package(python python3-palpate python "experiments in active touch - Python module
Reads runs of palpate as arrays, runs experiments, and asks where to tap, so
that an arm or a strategy can be a few lines of Python.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "palpate ${same_version}, python3 (>= 3.${PALPATE_PYTHON_MINOR}~), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/postinst
                                                ${CMAKE_CURRENT_LIST_DIR}/debian/prerm)
endif()
debian_package(baxter palpate-baxter science "experiments in active touch - driver for Baxter
Taps with the left arm of a Baxter, a robot of Rethink Robotics, over ROS 1:
plans the way down, feels the contact in the forces at the endpoint, watches
the robot meanwhile, and stops where it should.")
set(CPACK_DEBIAN_BAXTER_PACKAGE_DEPENDS "palpate ${same_version}")
include(CPack)

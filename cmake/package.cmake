# Debian packages by CPack: vbond, and libvbond-dev for programs that use the library. tools/package deb makes them.
set(VBOND_MAINTAINER "vbond developers <vbond@example.org>" CACHE STRING "Who made the package: NAME <ADDRESS>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "vbond developers")
set(CPACK_PACKAGE_CONTACT ${VBOND_MAINTAINER})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME vbond)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SECTION science)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "libvbond-dev, paraview, chromium")
set(CPACK_COMPONENT_UNSPECIFIED_DESCRIPTION "bonded-particle simulator of solids
Computes how solids that can be made of rigid particles and elastic bonds
deform, buckle, vibrate and break: fibres, shells, rock, ceramics,
agglomerates. It takes one case file and writes tables, pictures for ParaView
and a report page for any browser.")
if(VBOND_PYTHON)  # a module is compiled for one minor version of Python
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS
      "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/postinst
                                                     ${PROJECT_SOURCE_DIR}/packaging/debian/prerm)
  set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_CONTROL_STRICT_PERMISSION ON)
endif()

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libvbond-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "bonded-particle simulator of solids: C++ library
Headers, static libraries and the CMake package of vbond, for programs of
one's own: step loops, bond laws, equilibria, runs in several stages.")
# what the static library is linked with: cmake/vbondConfig.cmake.in
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libassimp-dev, libfmt-dev, libhdf5-dev, libtomlplusplus-dev, nlohmann-json3-dev, voro++-dev, zlib1g-dev")
if(VBOND_STATICS)
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libopenblas-pthread-dev | libopenblas-dev, libsuitesparse-dev")
endif()

set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian_files.cmake)
set(CPACK_VBOND_SOURCES ${PROJECT_SOURCE_DIR})
set(CPACK_VBOND_VERSION ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)

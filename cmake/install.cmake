# What `cmake --install` puts where, and the package that find_package(vbond) finds.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(vbond_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vbond)

install(TARGETS vbond_physics EXPORT vbondPhysicsTargets)
install(TARGETS vbond vbond_run EXPORT vbondTargets)
if(VBOND_STATICS)
  install(TARGETS vbond_statics EXPORT vbondTargets)
endif()
install(DIRECTORY src/vbond TYPE INCLUDE FILES_MATCHING PATTERN "*.hpp" PATTERN detail EXCLUDE PATTERN ranks EXCLUDE)
install(FILES LICENSE TYPE DOC)
# The page of `vbond report`, made by the set-up from web/; a program installed without it says what is missing.
install(FILES ${PROJECT_SOURCE_DIR}/build/page/report.html DESTINATION ${CMAKE_INSTALL_DATADIR}/vbond OPTIONAL)
install(EXPORT vbondPhysicsTargets NAMESPACE vbond:: DESTINATION ${vbond_package_dir})
install(EXPORT vbondTargets NAMESPACE vbond:: DESTINATION ${vbond_package_dir})

configure_package_config_file(cmake/vbondConfig.cmake.in ${PROJECT_BINARY_DIR}/vbondConfig.cmake
                              INSTALL_DESTINATION ${vbond_package_dir})
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vbondConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vbondConfig.cmake ${PROJECT_BINARY_DIR}/vbondConfigVersion.cmake
        DESTINATION ${vbond_package_dir})

# What `cmake --install` puts where, and the package that find_package(vbond) finds. The component dev is what only
# programs that use the library need.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(vbond_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vbond)

install(TARGETS vbond_physics EXPORT vbondPhysicsTargets COMPONENT dev)
install(TARGETS vbond vbond_report vbond_run EXPORT vbondTargets COMPONENT dev)
if(VBOND_STATICS)
  install(TARGETS vbond_statics EXPORT vbondTargets COMPONENT dev)
endif()
install(DIRECTORY src/vbond TYPE INCLUDE COMPONENT dev FILES_MATCHING PATTERN "*.hpp" PATTERN detail EXCLUDE PATTERN ranks EXCLUDE PATTERN fit EXCLUDE PATTERN labtest EXCLUDE)
install(EXPORT vbondPhysicsTargets NAMESPACE vbond:: DESTINATION ${vbond_package_dir} COMPONENT dev)
install(EXPORT vbondTargets NAMESPACE vbond:: DESTINATION ${vbond_package_dir} COMPONENT dev)

configure_package_config_file(cmake/vbondConfig.cmake.in ${PROJECT_BINARY_DIR}/vbondConfig.cmake
                              INSTALL_DESTINATION ${vbond_package_dir})
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vbondConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vbondConfig.cmake ${PROJECT_BINARY_DIR}/vbondConfigVersion.cmake
        DESTINATION ${vbond_package_dir} COMPONENT dev)

install(FILES LICENSE README.md CHANGELOG.md CITATION.cff TYPE DOC)
install(DIRECTORY docs TYPE DOC PATTERN docs/site EXCLUDE)  # how the site is built
install(DIRECTORY examples TYPE DOC PATTERN cpp EXCLUDE PATTERN rod_dynamic_modes EXCLUDE)  # which needs the sources
install(DIRECTORY examples/cpp DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT dev)

# The page of `vbond report`: from web/, with packages of npm. A program installed without it says what is missing.
add_custom_target(vbond_page COMMAND ${PROJECT_SOURCE_DIR}/tools/package page USES_TERMINAL VERBATIM)
install(FILES ${PROJECT_SOURCE_DIR}/build/page/report.html DESTINATION ${CMAKE_INSTALL_DATADIR}/vbond OPTIONAL)

# Manual pages and completion are what the program says of itself.
if(VBOND_APP AND NOT VBOND_PETSC AND (NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR))
  set(VBOND_ZSH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where completion for zsh goes")
  set(vbond_texts ${PROJECT_BINARY_DIR}/texts)
  install(CODE "
    set(program ${CMAKE_CROSSCOMPILING_EMULATOR} \"$<TARGET_FILE:vbond_program>\")
    file(REMOVE_RECURSE \"${vbond_texts}\")
    file(MAKE_DIRECTORY \"${vbond_texts}/man1\")
    execute_process(COMMAND \${program} manual --output \"${vbond_texts}/man1\" COMMAND_ERROR_IS_FATAL ANY)
    foreach(shell bash zsh fish)
      execute_process(COMMAND \${program} completion \${shell} OUTPUT_FILE \"${vbond_texts}/vbond.\${shell}\"
                      COMMAND_ERROR_IS_FATAL ANY)
    endforeach()")
  install(DIRECTORY ${vbond_texts}/man1 TYPE MAN)
  install(FILES ${vbond_texts}/vbond.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME vbond)
  install(FILES ${vbond_texts}/vbond.zsh DESTINATION ${VBOND_ZSH_COMPLETIONS} RENAME _vbond)
  install(FILES ${vbond_texts}/vbond.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()

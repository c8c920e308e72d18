# Run by CPack on the files of both packages before it packs them: what Debian wants of them, and whether all are there.
cmake_minimum_required(VERSION 3.25)
set(staged ${CPACK_TEMPORARY_INSTALL_DIRECTORY})

foreach(file usr/bin/vbond usr/share/vbond/report.html usr/share/man/man1/vbond.1
             usr/share/bash-completion/completions/vbond)
  if(NOT EXISTS ${staged}/Unspecified/${file})
    message(FATAL_ERROR "the package would lack /${file}; the report page is built by the target vbond_page")
  endif()
endforeach()

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component Unspecified dev)
  string(TOUPPER ${component} name)
  set(package ${CPACK_DEBIAN_${name}_PACKAGE_NAME})
  set(doc ${staged}/${component}/usr/share/doc/${package})
  file(MAKE_DIRECTORY ${doc})
  file(REMOVE ${doc}/LICENSE ${doc}/CHANGELOG.md)
  file(COPY_FILE ${CPACK_VBOND_SOURCES}/packaging/debian/copyright ${doc}/copyright)
  file(WRITE ${doc}/changelog.Debian "${package} (${CPACK_VBOND_VERSION}) unstable; urgency=medium

  * See changelog.gz, the changes of the program itself.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  file(COPY_FILE ${CPACK_VBOND_SOURCES}/CHANGELOG.md ${doc}/changelog)
  file(GLOB compressed ${doc}/changelog* ${staged}/${component}/usr/share/man/man1/*.1)
  file(CHMOD ${doc}/copyright ${compressed} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
endforeach()

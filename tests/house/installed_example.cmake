# Installs vbond, then configures, builds and runs examples/cpp against the installed copy alone,
# as a user of the library would; and takes vbond's sources as a subproject.
# Needs: sources, build, config, statics, work, compiler, flags.
set(example ${sources}/examples/cpp)
file(REMOVE_RECURSE ${work})

function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nfailed: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

step(${CMAKE_COMMAND} --install ${build} --config ${config} --prefix ${work}/prefix)
foreach(file share/doc/vbond/examples/rod_buckling.toml share/man/man1/vbond.1 share/man/man1/vbond-run.1
             share/bash-completion/completions/vbond share/zsh/site-functions/_vbond
             share/fish/vendor_completions.d/vbond.fish)
  if(NOT EXISTS ${work}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
step(${CMAKE_COMMAND} -S ${example} -B ${work}/build -G Ninja -D CMAKE_BUILD_TYPE=${config}
     -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_CXX_FLAGS=${flags}
     -D CMAKE_PREFIX_PATH=${work}/prefix)
step(${CMAKE_COMMAND} --build ${work}/build)
step(${work}/build/rod)
set(rod_output "${output}")

# The physics alone, for a program that has none of the library's dependencies.
step(${CMAKE_COMMAND} -S ${example}/physics -B ${work}/physics -G Ninja -D CMAKE_CXX_COMPILER=${compiler}
     -D CMAKE_PREFIX_PATH=${work}/prefix
     -D CMAKE_DISABLE_FIND_PACKAGE_fmt=ON -D CMAKE_DISABLE_FIND_PACKAGE_HDF5=ON -D CMAKE_DISABLE_FIND_PACKAGE_ZLIB=ON
     -D CMAKE_DISABLE_FIND_PACKAGE_tomlplusplus=ON -D CMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON
     -D CMAKE_DISABLE_FIND_PACKAGE_Threads=ON)
step(${CMAKE_COMMAND} --build ${work}/physics)
step(${work}/physics/bond)
# a bond of c_A = 1 stretched by 0.01
if(NOT output MATCHES "energy 5e-05, force 0\\.01[^0-9]")
  message(FATAL_ERROR "expected the energy 5e-05 and the force 0.01, the example printed:\n${output}")
endif()
set(output "${rod_output}")

# P L^3 / (3 E J) with P = 1e-7, L = 10, E J = d^2/16 = 0.0025, exact for Bernoulli-Euler bonds; the
# correction for finite deflection is 1.09 (w/L)^2 = 2e-6 of it, below the digits printed.
if(NOT output MATCHES "tip deflection 0\\.013333,")
  message(FATAL_ERROR "expected a tip deflection of 0.013333, the example printed:\n${output}")
endif()

# What a case asks for, written by a program: the same bytes as from vbond run.
set(case ${sources}/examples/fibre_bundle.toml)
step(${work}/prefix/bin/vbond run ${case} -o ${work}/by_vbond --quiet)
step(${work}/build/case_output ${case} ${work}/by_example)
file(GLOB_RECURSE written RELATIVE ${work}/by_example ${work}/by_example/*)
foreach(file ${written})
  step(${CMAKE_COMMAND} -E compare_files ${work}/by_example/${file} ${work}/by_vbond/${file})
endforeach()
file(GLOB_RECURSE expected RELATIVE ${work}/by_vbond ${work}/by_vbond/*)
list(REMOVE_ITEM expected resolved.toml run.json status.json)
if(NOT written STREQUAL expected OR NOT written MATCHES "breaks\\.csv")
  message(FATAL_ERROR "case_output wrote\n${written}\nand vbond run\n${expected}")
endif()

# A law of the program's own: the same bits with every instruction set of this machine and any number of threads.
foreach(set baseline avx2 avx512)
  foreach(threads 1 2 4)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env VBOND_SIMD=${set} ${work}/build/own_law ${threads}
                    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
    if(NOT status EQUAL 0 AND errors MATCHES "this machine can execute")
      continue()
    elseif(NOT status EQUAL 0)
      message(FATAL_ERROR "own_law ${threads} with ${set} failed: ${status}\n${output}${errors}")
    endif()
    if(NOT DEFINED first)
      set(first "${output}")
    elseif(NOT output STREQUAL first)
      message(FATAL_ERROR "own_law ${threads} with ${set} printed\n${output}instead of\n${first}")
    endif()
  endforeach()
endforeach()
if(NOT first MATCHES "broken [1-9]")
  message(FATAL_ERROR "no bond of own_law broke:\n${first}")
endif()
# EVM's small motions are those of the V-model: the same first mode as below, and the stretching of E A.
if(statics AND NOT first MATCHES "critical force 0\\.00030781[0-9]*")
  message(FATAL_ERROR "expected a critical force of 3.0781e-4, own_law printed:\n${first}")
endif()

# Nine bonds: 0.04 of flow each, and u = 0.0199681 with u (1 + 4 u^2) = 0.02.
if(statics AND NOT first MATCHES "drawn by 0\\.53971[0-9]*")
  message(FATAL_ERROR "expected the rod to be drawn by 0.53971, own_law printed:\n${first}")
endif()

# Mode 1 of the paper's rod: 3.07817634631e-4.
if(statics)
  step(${work}/build/buckling)
  if(NOT output MATCHES "critical force 0\\.000307817635")
    message(FATAL_ERROR "expected a critical force of 3.07817635e-4, the example printed:\n${output}")
  endif()

  # P L^3 / (3 E J) as above. The frequency is that of ten Bernoulli-Euler beam elements with lumped masses 1 and inertias
  # 0.064, clamped at one end: 1.595730346e-3 (inverse iteration with the 20 x 20 stiffness matrix of beam theory); the
  # balance it is taken about is bent by w/L = 1.3e-3, which changes it by some (w/L)^2 = 2e-6 of it.
  step(${work}/build/stages)
  if(NOT output MATCHES "under way, at step 5000\n.*tip deflection 0\\.01333[23].* after 10000 steps, slowest frequency 0\\.0015957[23]")
    message(FATAL_ERROR "expected 0.013333 after 10000 steps and 0.00159573, the example printed:\n${output}")
  endif()
endif()

# As a part of another project vbond makes its libraries only, needs nothing for program and tests, and installs nothing.
file(WRITE ${work}/whole/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(whole LANGUAGES C CXX)
add_subdirectory(${sources} vbond)
foreach(target vbond_program test_core vbond_page)
  if(TARGET \${target})
    message(FATAL_ERROR \"\${target} is a part of the whole\")
  endif()
endforeach()
add_executable(rod ${example}/rod.cpp)
target_link_libraries(rod PRIVATE vbond::run)
add_executable(bond ${example}/physics/bond.cpp)
target_link_libraries(bond PRIVATE vbond::physics)
")
step(${CMAKE_COMMAND} -S ${work}/whole -B ${work}/whole/build -G Ninja -D CMAKE_CXX_COMPILER=${compiler}
     -D VBOND_STATICS=${statics} -D CMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -D CMAKE_DISABLE_FIND_PACKAGE_GTest=ON
     -D CMAKE_DISABLE_FIND_PACKAGE_rapidcheck=ON)
step(${CMAKE_COMMAND} --build ${work}/whole/build --target bond)
step(${work}/whole/build/bond)
if(NOT output MATCHES "energy 5e-05, force 0\\.01[^0-9]")
  message(FATAL_ERROR "bond, in a project with vbond in it, printed:\n${output}")
endif()
step(${CMAKE_COMMAND} --build ${work}/whole/build --target rod -- -n)  # would be built: that takes minutes
step(${CMAKE_COMMAND} --install ${work}/whole/build --prefix ${work}/whole/prefix)
if(EXISTS ${work}/whole/prefix)
  message(FATAL_ERROR "vbond in another project installs itself")
endif()

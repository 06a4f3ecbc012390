# Configures, builds and runs a consumer project as its user would, from nothing, and looks at what it leaves.
#   cmake -D CONSUMER=<folder here> -D WORK=<folder to work in> -D PROTOSTAR_SOURCE_DIR=... ... -P run.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/run)

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK}/run COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# A file of at least this size that starts with these bytes, in hexadecimal.
function(expect_file path size start)
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "${path} is missing")
  endif()
  file(SIZE ${path} actual_size)
  file(READ ${path} bytes HEX)
  if(actual_size LESS size OR NOT bytes MATCHES "^${start}")
    message(FATAL_ERROR "${path} is not what it should be: ${actual_size} bytes")
  endif()
endfunction()

set(arguments -G ${CMAKE_GENERATOR} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_BUILD_TYPE=)
if(CONSUMER STREQUAL find_package)
  # Installed in one place, used in another: a package may be moved.
  run(${CMAKE_COMMAND} --install ${PROTOSTAR_BINARY_DIR} --prefix ${WORK}/staging)
  file(RENAME ${WORK}/staging ${WORK}/prefix)
  list(APPEND arguments -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  file(GLOB_RECURSE others RELATIVE ${WORK}/prefix ${WORK}/prefix/*)
  list(FILTER others EXCLUDE REGEX "^include/protostar/.*\\.hpp$|^[^/]*/([^/]*/)?cmake/protostar/.*\\.cmake$")
  set(examples share/doc/protostar/examples)
  foreach(file IN ITEMS CMakeLists.txt scenes/three_spheres.hpp accelerate.cpp departure.cpp integrator.cpp lens.cpp
      field.cpp light.cpp marched.cpp occlusion.cpp readme.cpp surface.cpp)
    if(NOT ${examples}/${file} IN_LIST others)
      message(FATAL_ERROR "${examples}/${file} is not installed")
    endif()
    list(REMOVE_ITEM others ${examples}/${file})
  endforeach()
  if(others)
    message(FATAL_ERROR "more than the headers, the package and the examples is installed: ${others}")
  endif()
else()
  list(APPEND arguments -DPROTOSTAR_SOURCE_DIR=${PROTOSTAR_SOURCE_DIR})
endif()
if(GLM_SOURCE_DIR)  # downloaded, so once is enough
  list(APPEND arguments -DFETCHCONTENT_SOURCE_DIR_GLM=${GLM_SOURCE_DIR})
endif()

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/${CONSUMER} -B ${WORK}/build ${arguments})
run(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)

run(${WORK}/build/consumer)
expect_file(${WORK}/run/out.ppm 921615 50360a363430203438300a3235350a)  # P6, 640 480, 255
foreach(program IN ITEMS two_units png)
  if(EXISTS ${WORK}/build/${program})
    run(${WORK}/build/${program})
  endif()
endforeach()
if(CONSUMER STREQUAL find_package AND HAS_PNG AND NOT EXISTS ${WORK}/build/png)
  message(FATAL_ERROR "the package has no protostar::png, which was installed")
endif()
if(EXISTS ${WORK}/build/png)
  expect_file(${WORK}/run/out.png 60 89504e470d0a1a0a)
endif()

if(CONSUMER STREQUAL find_package)
  # The examples as they are installed, of which one is built and run.
  run(${CMAKE_COMMAND} -S ${WORK}/prefix/${examples} -B ${WORK}/examples ${arguments})
  run(${CMAKE_COMMAND} --build ${WORK}/examples --target integrator)
  run(${WORK}/examples/integrator)
  expect_file(${WORK}/run/headlight.ppm 230400 50360a333230203234300a3235350a)  # P6, 320 240, 255
endif()

if(NOT CONSUMER STREQUAL find_package)
  run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
  if(EXISTS ${WORK}/prefix)
    message(FATAL_ERROR "a project that includes protostar installs it unasked")
  endif()
endif()

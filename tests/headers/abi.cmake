# The inline namespace is named after the instruction set: alike for flags that lead to the same, and otherwise
# where units must not be merged.
#   cmake -D CMAKE_CXX_COMPILER=... -D INCLUDE=<include folder> -D WORK=<folder to work in> -P abi.cmake
cmake_minimum_required(VERSION 3.25)
file(WRITE ${WORK}/abi.cpp "#include <protostar/platform.hpp>\nPROTOSTAR_ABI\n")

function(expect name)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -I${INCLUDE} ${ARGN} -E -P ${WORK}/abi.cpp
    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCH "[A-Za-z0-9_]+[ \n]*$" found "${text}")
  string(STRIP "${found}" found)
  if(NOT found STREQUAL name)
    message(SEND_ERROR "${ARGN}: the namespace is ${found}, not ${name}")
  endif()
endfunction()

expect(sse2 -march=x86-64)
expect(sse3 -march=x86-64 -msse3)
expect(ssse3 -march=x86-64 -mssse3)
expect(sse41 -march=x86-64 -msse4.1)
expect(sse42 -march=x86-64-v2)
expect(avx -march=x86-64 -mavx)
expect(avx2 -march=x86-64 -mavx2)
expect(avx2_fma -march=x86-64 -mavx2 -mfma)
expect(avx2_bmi -march=x86-64 -mavx2 -mbmi)
expect(avx2_bmi -march=x86-64 -mavx2 -mlzcnt)
expect(avx2_bmi2 -march=x86-64 -mavx2 -mbmi2)
foreach(processor IN ITEMS haswell znver1 x86-64-v3)
  expect(avx2_fma_bmi2 -march=${processor})
endforeach()
expect(avx512_fma_bmi2 -march=haswell -mavx512f)
foreach(processor IN ITEMS skylake-avx512 x86-64-v4)
  expect(avx512vl_fma_bmi2 -march=${processor})
endforeach()

// What the library asks of the compiler and the machine, and the inline namespace that says what it was built
// for.
#pragma once

#include <cfloat>
#include <limits>

#if !defined(__cpp_concepts) || __cpp_concepts < 201907L
#error "protostar needs C++20 with concepts: g++ 10, clang 10 or newer, with -std=c++20"
#endif

#if defined(__FAST_MATH__)
#error \
    "protostar cannot be compiled with -ffast-math: it lets the compiler reorder and drop the roundings on which every hit is decided"
#endif

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53 &&
                  std::numeric_limits<float>::is_iec559 && std::numeric_limits<float>::digits == 24,
              "protostar needs IEEE 754 float and double");

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error \
    "protostar needs double arithmetic in double (FLT_EVAL_METHOD 0): on 32-bit x86 compile with -msse2 -mfpmath=sse"
#endif

// Every declaration lives in protostar::PROTOSTAR_ABI, an inline namespace: nobody writes its name, the
// linker reads it. Two translation units that were compiled for different instruction sets then hold
// different functions, and a program that links both keeps both instead of silently merging them into one
// that half of its machines cannot run.
#if defined(__AVX512F__)
#define PROTOSTAR_ABI avx512
#elif defined(__AVX2__)
#define PROTOSTAR_ABI avx2
#elif defined(__AVX__)
#define PROTOSTAR_ABI avx
#elif defined(__SSE4_1__)
#define PROTOSTAR_ABI sse4
#elif defined(__SSE2__)
#define PROTOSTAR_ABI sse2
#else
#define PROTOSTAR_ABI generic
#endif

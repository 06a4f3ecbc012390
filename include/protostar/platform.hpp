// Requirements on the compiler and the machine, and the inline namespace named after the instruction set.
#pragma once

#include <cfloat>
#include <limits>

#if !defined(__cpp_concepts) || __cpp_concepts < 201907L
#error "protostar needs C++20 with concepts: g++ 10, clang 10 or newer, with -std=c++20"
#endif

// g++ has macros for -ffast-math and all of its options, clang only those in the first line of the condition.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error \
    "protostar cannot be compiled with -ffast-math or a part of it: it lets the compiler reorder and drop the roundings and the comparisons with NaN on which every hit is decided"
#endif

#if !defined(__cpp_exceptions)
#error \
    "protostar needs exceptions: it cannot be compiled with -fno-exceptions, as numbers and files that are not allowed are told by what a function throws"
#endif

#if defined(GLM_FORCE_XYZW_ONLY)
#error "protostar names the channels of a color r, g and b: GLM_FORCE_XYZW_ONLY takes these names away"
#endif

// The processor must also round to nearest and keep denormal numbers, as at the start of every program. A
// thread that calls fesetround or sets flush-to-zero gets other numbers; no header can detect that.
static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53 &&
                  std::numeric_limits<float>::is_iec559 && std::numeric_limits<float>::digits == 24,
              "protostar needs IEEE 754 float and double");

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error \
    "protostar needs double arithmetic in double (FLT_EVAL_METHOD 0): on 32-bit x86 compile with -msse2 -mfpmath=sse"
#endif

// Every declaration lives in protostar::PROTOSTAR_ABI, an inline namespace whose name nobody writes, but the
// linker reads. Two translation units that were compiled for different instruction sets then hold different
// functions, and a program that links both keeps both instead of silently merging them into one that half of
// its machines cannot run. This holds for the library's functions; GLM's and the standard library's have no
// such names. The name is that of the widest vectors, then _fma, _bmi or _bmi2, and _gfni, which
// simd/words.hpp uses: -march=haswell gives avx2_fma_bmi2, -mavx2 alone avx2. If a program defines
// PROTOSTAR_SCALAR, for which simd/vector_registers.hpp leaves vectors aside, the name ends in _scalar.
#if defined(__AVX512VL__)
#define PROTOSTAR_ABI_WIDTH avx512vl
#elif defined(__AVX512F__)
#define PROTOSTAR_ABI_WIDTH avx512
#elif defined(__AVX2__)
#define PROTOSTAR_ABI_WIDTH avx2
#elif defined(__AVX__)
#define PROTOSTAR_ABI_WIDTH avx
#elif defined(__SSE4_2__)
#define PROTOSTAR_ABI_WIDTH sse42
#elif defined(__SSE4_1__)
#define PROTOSTAR_ABI_WIDTH sse41
#elif defined(__SSSE3__)
#define PROTOSTAR_ABI_WIDTH ssse3
#elif defined(__SSE3__)
#define PROTOSTAR_ABI_WIDTH sse3
#elif defined(__SSE2__)
#define PROTOSTAR_ABI_WIDTH sse2
#else
#define PROTOSTAR_ABI_WIDTH generic
#endif

#if defined(__FMA__)
#define PROTOSTAR_ABI_FMA _fma
#else
#define PROTOSTAR_ABI_FMA
#endif

#if defined(__BMI2__)
#define PROTOSTAR_ABI_BITS _bmi2
#elif defined(__BMI__) || defined(__LZCNT__)
#define PROTOSTAR_ABI_BITS _bmi
#else
#define PROTOSTAR_ABI_BITS
#endif

#if defined(__GFNI__)
#define PROTOSTAR_ABI_BYTES _gfni
#else
#define PROTOSTAR_ABI_BYTES
#endif

#if defined(PROTOSTAR_SCALAR)
#define PROTOSTAR_ABI_LANES _scalar
#else
#define PROTOSTAR_ABI_LANES
#endif

#define PROTOSTAR_ABI_JOIN(a, b, c, d, e) a##b##c##d##e
#define PROTOSTAR_ABI_NAME(a, b, c, d, e) PROTOSTAR_ABI_JOIN(a, b, c, d, e)
#define PROTOSTAR_ABI                                                                                 \
  PROTOSTAR_ABI_NAME(PROTOSTAR_ABI_WIDTH, PROTOSTAR_ABI_FMA, PROTOSTAR_ABI_BITS, PROTOSTAR_ABI_BYTES, \
                     PROTOSTAR_ABI_LANES)

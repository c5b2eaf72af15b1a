// Portable: what differs between the device and a host that compiles these kernels as plain C++.
//
// Results are those of the Rust engine bit by bit, so products and sums are never fused: `--fmad=false` on the device,
// `-ffp-contract=off` on the host. Numbers are added, subtracted, multiplied and divided, and roots are taken, which IEEE 754
// rounds in one way; no other function of a mathematics library is used.
#pragma once

#ifdef __CUDACC__
#define DEVICE __device__ inline
// A function that is called from several places, and large: one copy of it keeps the kernels small.
#define DEVICE_CALL __device__ __noinline__
#else
#include <cmath>
#define DEVICE inline
#define DEVICE_CALL inline
#endif

typedef unsigned int u32;
typedef unsigned long long u64;
typedef long long i64;

#define INFINITE (1.0 / 0.0)

DEVICE double least(double a, double b) { return a < b ? a : b; }

DEVICE double greatest(double a, double b) { return a > b ? a : b; }

// The nearest number in [0, 1].
DEVICE double unit_interval(double x) {
    x = x > 0.0 ? x : 0.0;
    return x < 1.0 ? x : 1.0;
}

DEVICE bool is_finite(double x) { return x - x == 0.0; }

// Bits of a number.
DEVICE u64 bits_of(double x) {
#ifdef __CUDACC__
    return (u64)__double_as_longlong(x);
#else
    u64 bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    return bits;
#endif
}

// The number of some bits.
DEVICE double number_of(u64 bits) {
#ifdef __CUDACC__
    return __longlong_as_double((i64)bits);
#else
    double x;
    __builtin_memcpy(&x, &bits, sizeof x);
    return x;
#endif
}

// Adds to a word that other threads add to, and returns what it was.
DEVICE u64 add_shared(u64 *word, u64 summand) {
#ifdef __CUDACC__
    return atomicAdd(word, summand);
#else
    const u64 before = *word;
    *word += summand;
    return before;
#endif
}

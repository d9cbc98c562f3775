// SPDX-License-Identifier: GPL-3.0-or-later
// Marks an inner loop to be compiled once for each vector width and chosen when the program starts. For
// integers and separately rounded floats only: every version then gives the same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    defined(__gnu_linux__)
#define DENDROFIT_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define DENDROFIT_VECTORISED
#endif

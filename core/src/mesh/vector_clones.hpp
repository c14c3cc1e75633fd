// Compiles a hot function once per vector width and picks one when the program is loaded.
//
// The bits do not depend on which clone runs: contraction to fused multiply–add is off and no loop
// reorders a sum, so that wider registers only do more of the same operations at once. Clones are
// named by feature: GCC matches "arch=…" against the vendor's model number, which leaves a
// processor of another vendor with the slowest clone.
#pragma once

// The sanitizers' run-times are not ready when the resolver runs.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PILEUS_VECTOR_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define PILEUS_VECTOR_CLONES
#endif

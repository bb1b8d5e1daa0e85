// Counts calls of malloc, calloc, realloc and aligned_alloc in this executable, in every thread: Eigen and
// CHOLMOD allocate with these, and operator new ends in them.
#pragma once

namespace bb::test {
/// False where a sanitizer owns malloc: then nothing is counted.
bool counts_mallocs();
long n_mallocs();
}  // namespace bb::test

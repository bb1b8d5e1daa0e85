// The kernels of the tests as PTX.
#include "core/exec/cuda/device_block.cuh"
#include "tests/exec/sample_kernels.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::sample::Square)
BLOCKS(bb::sample::BlockSums)
BLOCKS(bb::sample::LargestOfSome)
BLOCKS(bb::sample::TileSums<4>)
BLOCKS(bb::sample::TileSums<32>)
EACH(bb::sample::Atomics)
EACH(bb::sample::LastArrival)
EACH(bb::sample::Walk)
EACH(bb::sample::Library)
EACH(bb::sample::Integers)

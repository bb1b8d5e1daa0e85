// The PTX that the stand-in runs: the kernels of the test and the probe's.
#include "core/exec/cuda/device_block.cuh"
#include "core/exec/cuda/self_test.hpp"
#include "tests/ptx/instantiate.cuh"
#include "tests/standin/device_kernels.hpp"

#include "tests/standin/device_kernels.inc"
EACH(bb::cuda::SelfTest)

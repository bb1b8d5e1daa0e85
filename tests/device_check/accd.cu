// PTX of the checks in accd_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/accd_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::Sweeps<double>)

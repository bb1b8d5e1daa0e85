// PTX of the checks in distance_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/distance_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::Distances<double>)
EACH(bb::device_check::Mollifier<double>)

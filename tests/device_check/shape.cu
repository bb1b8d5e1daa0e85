// PTX of the checks in shape_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/shape_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::EveryShape<double>)
EACH(bb::device_check::EveryShape<float>)

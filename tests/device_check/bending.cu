// PTX of the checks in bending_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/bending_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::Spring<double>)
EACH(bb::device_check::Spring<float>)
EACH(bb::device_check::Hinge<double>)

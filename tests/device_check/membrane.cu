// PTX of the checks in membrane_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/membrane_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::Membranes<double>)
EACH(bb::device_check::StrainLimit<double>)

// PTX of the checks in math_checks.hpp.
#include "core/exec/cuda/device_block.cuh"
#include "tests/device_check/math_checks.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::device_check::Elementary<double>)
EACH(bb::device_check::Elementary<float>)
EACH(bb::device_check::Svds<double>)
EACH(bb::device_check::Svds<float>)
EACH(bb::device_check::SymmetricEigen<double, 2>)
EACH(bb::device_check::SymmetricEigen<double, 3>)
EACH(bb::device_check::SymmetricEigen<double, 9>)
EACH(bb::device_check::SymmetricEigen<double, 12>)

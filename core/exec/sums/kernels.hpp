// All kernels of this module.
#pragma once

#include "core/exec/sums/sum_kernels.hpp"

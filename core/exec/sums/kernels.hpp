// All kernels of this room.
#pragma once

#include "core/exec/sums/sum_kernels.hpp"

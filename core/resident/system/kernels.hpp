// All kernels of this room.
#pragma once

#include "core/exec/sums/sum_kernels.hpp"
#include "core/exec/sums/vector_kernels.hpp"
#include "core/resident/contact/sum_kernels.hpp"

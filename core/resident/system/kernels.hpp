// All kernels of this room.
#pragma once

#include "core/resident/sums/sum_kernels.hpp"
#include "core/resident/sums/vector_kernels.hpp"
#include "core/resident/system/row_totals.hpp"

// All kernels of this room.
#pragma once

#include "core/exec/sums/sum_kernels.hpp"
#include "core/exec/sums/vector_kernels.hpp"
#include "core/resident/elements/cloth_spring_kernels.hpp"
#include "core/resident/elements/element_kernels.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/gather_kernels.hpp"
#include "core/resident/elements/inflation_kernels.hpp"
#include "core/resident/elements/limit_kernels.hpp"
#include "core/resident/elements/load_kernels.hpp"
#include "core/resident/elements/quadratic_kernels.hpp"

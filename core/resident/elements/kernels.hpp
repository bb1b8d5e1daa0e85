// All kernels of this room.
#pragma once

#include "core/resident/elements/element_kernels.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/gather_kernels.hpp"
#include "core/resident/elements/limit_kernels.hpp"
#include "core/resident/elements/limit_shapes.hpp"
#include "core/resident/elements/load_kernels.hpp"
#include "core/resident/elements/sum_kernels.hpp"
#include "core/resident/elements/vector_kernels.hpp"

// Every kernel of this room, for the lists of kernels.inc.
#pragma once

#include "core/resident/linear/block_jacobi_kernels.hpp"
#include "core/resident/linear/pcg_kernels.hpp"
#include "core/resident/linear/schwarz_kernels.hpp"

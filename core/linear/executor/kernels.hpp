// Every kernel of this module, for the lists of kernels.inc.
#pragma once

#include "core/linear/executor/block_jacobi_kernels.hpp"
#include "core/linear/executor/pcg_kernels.hpp"
#include "core/linear/executor/schwarz_kernels.hpp"

// All kernels of this module.
#pragma once

#include "core/contact/executor/sum_kernels.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/exec/sums/vector_kernels.hpp"

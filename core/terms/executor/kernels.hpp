// All kernels of this module.
#pragma once

#include "core/energy/families/cloth_springs.hpp"
#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/hinges.hpp"
#include "core/energy/families/inflation.hpp"
#include "core/energy/families/limit_kernels.hpp"
#include "core/energy/families/membrane.hpp"
#include "core/energy/families/quadratics.hpp"
#include "core/energy/families/rods.hpp"
#include "core/energy/families/springs.hpp"
#include "core/energy/families/tetrahedra.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/exec/sums/vector_kernels.hpp"
#include "core/terms/executor/gather_kernels.hpp"
#include "core/terms/executor/load_kernels.hpp"

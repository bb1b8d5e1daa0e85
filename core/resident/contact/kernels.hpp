// Every kernel of the room, for what instantiates them; their names are in kernels.inc.
#pragma once

#include "core/contact/stiffness_kernels.hpp"
#include "core/energy/friction_list.hpp"
#include "core/exec/sums/compaction_kernels.hpp"
#include "core/resident/contact/bound_kernels.hpp"
#include "core/resident/contact/candidate_kernels.hpp"
#include "core/resident/contact/detour_kernels.hpp"
#include "core/resident/contact/gather_kernels.hpp"
#include "core/resident/contact/lagged_kernels.hpp"
#include "core/resident/contact/row_kappa.hpp"
#include "core/resident/contact/row_kernels.hpp"
#include "core/resident/contact/shape_kernels.hpp"
#include "core/resident/contact/slot_kernels.hpp"
#include "core/resident/contact/sum_kernels.hpp"
#include "core/resident/contact/term_kernels.hpp"
#include "core/resident/contact/tree_kernels.hpp"

// All kernels of the room.
#pragma once

#include "core/resident/contact/bound_kernels.hpp"
#include "core/resident/contact/candidate_kernels.hpp"
#include "core/resident/contact/tree_kernels.hpp"

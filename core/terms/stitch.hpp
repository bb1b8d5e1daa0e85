// The springs that stitch vertices together.
#pragma once

#include "core/energy/families/element_family.hpp"
#include "core/scene/scene.hpp"

namespace bb {

/// The stitches outlive it. Errors: OutOfMemory.
std::unique_ptr<ElementFamily> stitch_family(const FamilyPlace& place, const Stitches& stitches);

}  // namespace bb

// The settings of a material: the keys of every part, as a config, help and the schema have them.
#pragma once

#include "core/bodies/body_spec.hpp"
#include "core/parameters/settings.hpp"

namespace bb {

/// Kept by settings_of<Material>().
template <>
Settings<Material> list_of();

}  // namespace bb

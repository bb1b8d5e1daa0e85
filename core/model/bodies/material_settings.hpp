// The settings of a material: the keys of every part, as a config, help and the schema have them.
#pragma once

#include "core/base/parameters/settings.hpp"
#include "core/model/bodies/body_spec.hpp"

namespace bb {

/// Kept by settings_of<Material>().
template <>
Settings<Material> list_of();

}  // namespace bb

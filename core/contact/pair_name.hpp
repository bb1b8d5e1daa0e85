// A contact in words.
#pragma once

#include <string>

#include "core/contact/contact_table.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// "point_triangle: cloth[12], ball[3], ball[4], ball[7]": bodies and their own vertex numbers, obstacles
/// by name.
std::string pair_name(const Scene& scene, const ContactKey& key, ContactKind kind);

}  // namespace bb

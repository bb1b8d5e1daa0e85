// Which two bodies a contact is between.
#pragma once

#include <string>
#include <utility>

#include "core/contact/contact_table.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// Two owners, the smaller first: bodies by number, then obstacles. A body may meet itself.
using BodyPair = std::pair<int, int>;

/// Of the vertices and the obstacle of a contact.
BodyPair body_pair(const Scene& scene, const ContactKey& key);
/// Of one of a BodyPair.
const std::string& owner_name(const Scene& scene, int owner);
/// "body|body" or "body|obstacle", the names sorted.
std::string name_of(const Scene& scene, const BodyPair& pair);

}  // namespace bb

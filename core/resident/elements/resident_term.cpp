#include "core/resident/elements/resident_term.hpp"

#include "core/archive/archive.hpp"

namespace bb::resident {

void ResidentTerm::keep(Archive& archive) { archive.section(name()); }

}  // namespace bb::resident

// Counts calls of operator new in this executable, in every thread.
#pragma once

namespace bb {
long n_allocations();
}

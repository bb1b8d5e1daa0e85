// How the allocator treats memory that a step gives back.
#pragma once

namespace bb::cli {

/// Keeps freed memory in the process: every iteration requests the same large buffers again (a factor and its
/// analysis, contact rows), and pages that the kernel hands out anew cost a fault and a clearing each. Does
/// nothing with another C library than glibc.
void keep_freed_memory();

}  // namespace bb::cli

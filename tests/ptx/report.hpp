// What a test executable ran: instructions of the PTX that were executed, and traffic of the kernels.
#pragma once

#include "tests/ptx/machine.hpp"

namespace ptx {

/// Environment: BB_PTX_PROFILE names a file; traffic is counted and written there.
bool profile_wanted();
/// Adds the traffic of a machine to the report and forgets it there.
void note_traffic(Machine& machine);

/// Prints executed and all instructions by module, kernels below `least` with their first lines that did not run.
/// judged: names of modules, a blank between. @return whether there are such, and each has `least`.
bool report(double least, std::string_view judged);
/// Writes instructions and traffic by kernel to BB_PTX_PROFILE where it is set.
void write_profile();

/// Prints a line `fault MODULE NUMBER RAN LINE KIND; FUNCTION` for each instruction that can be broken.
void list_faults();

}  // namespace ptx

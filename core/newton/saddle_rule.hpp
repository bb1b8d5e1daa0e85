// What a step solver does where a step would end in a saddle of E.
#pragma once

namespace bb {

/// Where a step would end although the exact matrix is not positive definite. escape: the step goes on along negative
/// curvature, of a step solver that tests energies. report: it ends there and says saddle. ignore: nobody looks.
enum class SaddleRule { escape, report, ignore };

}  // namespace bb

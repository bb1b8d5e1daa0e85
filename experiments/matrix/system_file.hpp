// A linear system of Newton as two files: NAME.mtx, the matrix, and NAME.json beside it, its side-car with
// everything else (docs/results/method/hard-systems.md).
#pragma once

#include <string>
#include <vector>

#include "core/base/record/trace_row.hpp"
#include "core/linear/block_system.hpp"

namespace bb {

inline constexpr const char* side_car_schema = "barrierbench.matrix/1";

/// Where a system comes from. What is unknown is empty, or -1.
struct SystemOrigin {
  std::string scene, formulation, integrator, git_commit;
  double dt_s = -1;
  int step = -1, iteration = -1;
  /// Which matrix of the iteration: "solved" is the one that was solved last, "clamped" that with every element
  /// clamped, also where it is the solved one, "exact" that of exact Hessians, where another was solved.
  std::string form;
  std::string cause;  // of its conditioning, a few words
};

/// What the run that wrote a system knew of its condition number.
struct KnownCond {
  Scaling scaling = Scaling::none;
  int tier = 2;
  ConditionStatus status = ConditionStatus::ok;
  double cond = 0, lambda_min = 0, lambda_max = 0;  // NaN where unknown
};

struct StoredSystem {
  ReducedSystem system;
  VecXd rhs;
  std::string rhs_source;          // "side-car", or "A * ones" where there is none
  std::vector<Vec3d> coordinates;  // m, [n_blocks] of the vertices; may be empty
  SystemOrigin origin;
  std::vector<KnownCond> cond;
  bool has_side_car = false;
};

/// The words that a form may be.
const std::vector<std::string>& matrix_forms();

/// The side-car of a matrix whose file has the name `matrix_name` and these bytes.
std::string side_car_text(const StoredSystem& stored, const std::string& matrix_name,
                          const std::string& matrix_bytes);

/// NAME.mtx with NAME.json, if that is there. Without it: blocks of 3 if that divides the rows, else of 1, and
/// the right-hand side A * ones, whose solution is known.
/// Errors: ConfigError as parse_matrix_market, and with the pointer into the side-car for a schema, key, type
/// or number that it may not have, and for what does not fit the matrix: its hash, rows, right-hand side,
/// blocks, coordinates.
StoredSystem read_system(const std::string& path);

}  // namespace bb

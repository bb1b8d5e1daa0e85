#include "experiments/matrix/system_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "experiments/matrix/matrix_market.hpp"
#include "experiments/matrix/side_car.hpp"

namespace bb {
namespace {

using nlohmann::ordered_json;

ordered_json number_or_null(double v) { return std::isfinite(v) ? ordered_json(v) : ordered_json(nullptr); }

ordered_json to_json(const KnownCond& known) {
  return {{"scaling", to_string(known.scaling)},
          {"tier", known.tier},
          {"status", to_string(known.status)},
          {"cond", number_or_null(known.cond)},
          {"lambda_min", number_or_null(known.lambda_min)},
          {"lambda_max", number_or_null(known.lambda_max)}};
}

void add_origin(const SystemOrigin& origin, ordered_json& out) {
  const auto add = [&out](const char* key, const std::string& text) {
    if (!text.empty()) out[key] = text;
  };
  add("scene", origin.scene);
  add("formulation", origin.formulation);
  add("integrator", origin.integrator);
  if (origin.dt_s > 0) out["dt_s"] = origin.dt_s;
  if (origin.step >= 0) out["step"] = origin.step;
  if (origin.iteration >= 0) out["iteration"] = origin.iteration;
  add("form", origin.form);
  add("cause", origin.cause);
  add("git_commit", origin.git_commit);
}

/// Blocks and right-hand side of a matrix that nothing is known of.
void fill_unknown(StoredSystem& stored) {
  const int n = static_cast<int>(stored.system.lower.rows()), size = n % 3 == 0 ? 3 : 1;
  stored.system.block_start.clear();
  for (int i = 0; i <= n; i += size) stored.system.block_start.push_back(i);
  stored.rhs = stored.system.lower.selfadjointView<Eigen::Lower>() * VecXd::Ones(n);
  stored.rhs_source = "A * ones";
}

}  // namespace

const std::vector<std::string>& matrix_forms() {
  static const std::vector<std::string> forms{"solved", "clamped", "exact"};
  return forms;
}

std::string side_car_text(const StoredSystem& stored, const std::string& matrix_name,
                          const std::string& matrix_bytes) {
  ordered_json out;
  out["schema"] = side_car_schema;
  out["matrix"] = {{"file", matrix_name},
                   {"sha256", sha256_hex(matrix_bytes)},
                   {"rows", stored.system.lower.rows()},
                   {"entries", stored.system.lower.nonZeros()}};
  add_origin(stored.origin, out);
  if (!stored.cond.empty()) out["cond"] = ordered_json::array();
  for (const KnownCond& known : stored.cond) out["cond"].push_back(to_json(known));
  out["block_start"] = stored.system.block_start;
  if (!stored.system.block_vertex.empty()) out["block_vertex"] = stored.system.block_vertex;
  if (!stored.coordinates.empty()) out["coordinates_m"] = ordered_json::array();
  for (const Vec3d& x : stored.coordinates) out["coordinates_m"].push_back({x[0], x[1], x[2]});
  out["rhs"] = ordered_json::array();
  for (const double b : stored.rhs) out["rhs"].push_back(number_or_null(b));
  std::string text = "{";  // a key a line
  for (const auto& [key, value] : out.items()) {
    text += fmt::format("{}\n  \"{}\": {}", text.size() > 1 ? "," : "", key, value.dump());
  }
  return text + "\n}\n";
}

StoredSystem read_system(const std::string& path) {
  StoredSystem stored;
  const std::string bytes = read_input_file(path, matrix_file);
  stored.system.lower = parse_matrix_market(bytes, path);
  stored.system.pattern_id = 1;
  fill_unknown(stored);
  const std::filesystem::path side_car = std::filesystem::path(path).replace_extension(".json");
  std::error_code error;  // a link that leads nowhere is a side-car that cannot be read
  const auto found = std::filesystem::symlink_status(side_car, error).type();
  if (side_car == path || found == std::filesystem::file_type::not_found) return stored;
  read_side_car(side_car.string(), sha256_hex(bytes), stored);
  return stored;
}

}  // namespace bb

#include "experiments/config/weights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/input/text_scanner.hpp"
#include "experiments/config/hashed_file.hpp"
#include "experiments/config/weight_formula.hpp"

namespace bb {
namespace {

using nlohmann::json;

std::vector<double> numbers_of(const HashedFile& file, std::size_t n) {
  const std::string bytes = unchanged(file, weights_file);
  TextScanner lines(bytes, file.path);
  std::vector<double> out;
  while (lines.next_line()) {
    if (lines.words().empty()) continue;
    const char* const allowed = "one number from 0 to 1 in a line";
    if (lines.words().size() > 1) lines.fail(fmt::format("{} words", lines.words().size()), allowed);
    out.push_back(lines.value<double>(lines.word(0), allowed));
    if (!(out.back() >= 0 && out.back() <= 1)) lines.fail(std::string(lines.word(0)), allowed);
  }
  if (out.size() != n) {
    throw ConfigError(file.path, fmt::format("{} numbers", out.size()),
                      fmt::format("{}, one a vertex of the body", n));
  }
  return out;
}

/// Of the last box that it is in.
double in_boxes(const std::vector<WeightBox>& boxes, const Vec3d& at) {
  double out = 0;
  for (const WeightBox& box : boxes) {
    const auto x = at.array();
    if ((x >= (*box.box)[0].array()).all() && (x <= (*box.box)[1].array()).all()) out = box.weight;
  }
  return out;
}

double on_ramp(const WeightGroupConfig& group, const Vec3d& at) {
  return std::clamp((group.axis.normalized().dot(at) - *group.from) / (*group.to - *group.from), 0.0, 1.0);
}

/// What is wrong with it alone, whatever the body.
void check_formula(const std::string& formula, const std::string& pointer, const Reader& reader) {
  try {
    require_weight_formula(formula, reader.source + "#" + pointer);
  } catch (const ConfigError& error) {
    reader.violations.insert(reader.violations.end(), error.violations().begin(), error.violations().end());
  }
}

std::vector<double> numbers_of(const WeightGroupConfig& group, const Positions& start,
                               const std::string& where) {
  if (!group.file.path.empty()) return numbers_of(group.file, static_cast<std::size_t>(start.cols()));
  if (!group.formula.empty()) return formula_weights(group.formula, start, where + "/formula");
  std::vector<double> out;
  for (Eigen::Index v = 0; v < start.cols(); ++v) {
    const Vec3d x = start.col(v);
    out.push_back(group.from ? on_ramp(group, x) : in_boxes(group.boxes, x));
  }
  return out;
}

}  // namespace

void read_weights(const json& body, const std::string& pointer, const Reader& reader,
                  std::vector<WeightGroupConfig>& groups) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    WeightGroupConfig& group = groups[i];
    const json& object = body.at("weights").at(i);
    const std::string where = fmt::format("{}/weights/{}", pointer, i);
    if (object.contains("file")) read_hashed(object, weights_file, where, reader, group.file);
    if (!group.formula.empty()) check_formula(group.formula, where + "/formula", reader);
    if (!reader.complete) continue;
    const bool ramp = group.from && group.to;
    if (group.from.has_value() != group.to.has_value()) {
      reader.missing(where + (group.from ? "/to_m" : "/from_m"), "both from_m and to_m of a ramp (m)");
    } else if (object.contains("file") + !group.boxes.empty() + !group.formula.empty() + ramp != 1) {
      reader.complain(where, "no weights, or two ways to state them",
                      "one of file, boxes, formula, from_m with to_m");
    } else if (ramp && *group.from == *group.to) {
      reader.complain(where + "/to_m", fmt::format("{}", *group.to), "another number than from_m (m)");
    } else if (!ramp && object.contains("axis") && group.axis != WeightGroupConfig().axis) {
      reader.complain(where + "/axis", object["axis"].dump(), "nothing without from_m and to_m");
    }
  }
}

std::vector<WeightGroup> make_weights(const std::vector<WeightGroupConfig>& groups, const Positions& start,
                                      const std::string& where) {
  std::vector<WeightGroup> out;
  for (std::size_t i = 0; i < groups.size(); ++i)
    out.push_back({groups[i].name, numbers_of(groups[i], start, fmt::format("{}/weights/{}", where, i))});
  return out;
}

}  // namespace bb

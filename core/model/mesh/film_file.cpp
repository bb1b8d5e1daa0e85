#include "core/model/mesh/film_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "core/math/error.hpp"
#include "core/model/mesh/bounds.hpp"
#include "core/model/mesh/frame_mesh.hpp"
#include "core/model/mesh/same_cells.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

/// A file name round its last number.
struct NumberedName {
  std::string before, after;
  unsigned long long number = 0;
};

std::optional<NumberedName> numbered(const std::string& name) {
  constexpr std::string_view digits = "0123456789";
  const std::size_t stem = fs::path(name).stem().string().size();
  const std::size_t last = name.substr(0, stem).find_last_of(digits);
  if (last == std::string::npos) return std::nullopt;
  const std::size_t other = name.find_last_not_of(digits, last),
                    first = other == std::string::npos ? 0 : other + 1;
  NumberedName out{name.substr(0, first), name.substr(last + 1), 0};
  const auto [end, error] = std::from_chars(name.data() + first, name.data() + last + 1, out.number);
  if (error != std::errc() || end != name.data() + last + 1) return std::nullopt;
  return out;
}

using Sequence = std::map<unsigned long long, fs::path>;

Sequence sequence_of(const fs::path& first, const NumberedName& pattern) {
  Sequence out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(first.parent_path(), error)) {
    const auto found = numbered(entry.path().filename().string());
    if (!found || found->before != pattern.before || found->after != pattern.after) continue;
    if (found->number < pattern.number) continue;
    const auto [place, is_new] = out.emplace(found->number, entry.path());
    if (!is_new) {
      throw ConfigError(entry.path().string(), "the number of " + place->second.filename().string(),
                        "one frame a number");
    }
  }
  if (error) throw ConfigError(first.parent_path().string(), error.message(), "a folder of mesh files");
  return out;
}

/// In even steps: a number that is missing is a frame that is missing.
void require_no_hole(const Sequence& files) {
  unsigned long long least = std::numeric_limits<unsigned long long>::max();
  for (auto at = std::next(files.begin()); at != files.end(); ++at) {
    least = std::min(least, at->first - std::prev(at)->first);
  }
  for (auto at = std::next(files.begin()); at != files.end(); ++at) {
    const auto& [before, earlier] = *std::prev(at);
    if (at->first - before == least) continue;
    throw ConfigError(earlier.parent_path().string(),
                      fmt::format("no frame between {} and {}", earlier.filename().string(),
                                  at->second.filename().string()),
                      fmt::format("numbers in even steps, here of {}", least));
  }
}

}  // namespace

std::vector<std::string> film_files(const std::string& first) {
  const fs::path path(first);
  const auto pattern = numbered(path.filename().string());
  if (!pattern) throw ConfigError(first, "a name without a number", "the first of numbered mesh files");
  const Sequence files = sequence_of(path, *pattern);
  if (!files.contains(pattern->number))
    throw ConfigError(first, "no such file", "the first of numbered mesh files");
  if (files.size() < 2) {
    throw ConfigError(first, "a film of one frame",
                      "two or more: files whose names differ in this number alone");
  }
  require_no_hole(files);
  std::vector<std::string> out;
  for (const auto& [number, file] : files) out.push_back(file.string());
  return out;
}

std::string film_times_file(const std::string& first) {
  const fs::path file = fs::path(first).parent_path() / "times.csv";
  std::error_code error;
  return fs::is_regular_file(file, error) ? file.string() : "";
}

std::vector<double> parse_film_times(const std::string& bytes, const std::string& name) {
  std::istringstream lines(bytes);
  std::string line, field;
  const auto next_line = [&lines, &line] {
    const bool there = static_cast<bool>(std::getline(lines, line));
    if (there && line.ends_with('\r')) line.pop_back();
    return there;
  };
  next_line();
  std::istringstream header(line);
  int column = -1;
  for (int k = 0; std::getline(header, field, ','); ++k) {
    if (field == "time_s") column = k;
  }
  if (column < 0) throw ConfigError(name + ":1", "no column time_s", "a header that names one");
  std::vector<double> out;
  for (int n = 2; next_line(); ++n) {
    if (line.empty()) continue;
    std::istringstream fields(line);
    for (int k = 0; k <= column; ++k) {
      field.clear();  // a row may have fewer fields than the header
      std::getline(fields, field, ',');
    }
    double time = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), time);
    if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(time)) {
      throw ConfigError(fmt::format("{}:{}", name, n), '"' + field + '"', "a finite number (s)");
    }
    out.push_back(time);
  }
  return out;
}

Positions parse_film_frame(const std::string& bytes, const std::string& name, const TriangleMesh& of) {
  FrameMesh frame = parse_frame(bytes, name);
  if (frame.vertices.cols() != of.n_vertices()) {
    throw ConfigError(name, fmt::format("{} vertices", frame.vertices.cols()),
                      fmt::format("{}, as the mesh of the body has", of.n_vertices()));
  }
  // A face of more than three corners may be cut otherwise in another pose; of a solid a frame may have the surface.
  if (!frame.triangles.empty() && of.fans.empty() && of.tetrahedra.empty())
    require_same_cells(name, "triangles", frame.triangles, of.triangles);
  if (!frame.segments.empty()) require_same_cells(name, "lone edges", frame.segments, of.segments);
  if (!frame.tetrahedra.empty()) require_same_cells(name, "tetrahedra", frame.tetrahedra, of.tetrahedra);
  for (Eigen::Index v = 0; v < frame.vertices.cols(); ++v) {
    if ((frame.vertices.col(v).array().abs() <= max_coordinate).all()) continue;
    throw ConfigError(name,
                      fmt::format("vertex {} at ({}, {}, {})", v, frame.vertices(0, v), frame.vertices(1, v),
                                  frame.vertices(2, v)),
                      allowed_coordinates());
  }
  return std::move(frame.vertices);
}

}  // namespace bb

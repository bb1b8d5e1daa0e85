#include "experiments/matrix/side_car.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/input/json.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

using nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const std::vector<std::string>& keys() {
  static const std::vector<std::string> all{
      "schema",      "matrix",     "scene",        "formulation",   "integrator", "dt_s",
      "step",        "iteration",  "form",         "cause",         "git_commit", "cond",
      "block_start", "block_size", "block_vertex", "coordinates_m", "rhs"};
  return all;
}

std::string shown(const json& value) {
  std::string text = value.dump();
  return text.size() > 60 ? text.substr(0, 60) + "..." : text;
}

class Reader {
 public:
  Reader(const std::string& path, const std::string& sha256, StoredSystem& stored)
      : path_(path), sha256_(sha256), stored_(stored), n_(stored.system.lower.rows()) {}

  void read(const std::string& text) {
    json_ = parse_json(text, path_);
    if (!json_.is_object()) throw ConfigError(path_, shown(json_), "an object");
    if (!json_.contains("schema") || json_["schema"] != side_car_schema) {
      throw ConfigError(path_ + "#/schema", json_.contains("schema") ? shown(json_["schema"]) : "nothing",
                        fmt::format("\"{}\"", side_car_schema));
    }
    for (const auto& [key, value] : json_.items()) {
      if (std::find(keys().begin(), keys().end(), key) == keys().end()) {
        complain("/" + key, shown(value), fmt::format("one of {}", fmt::join(keys(), ", ")));
      }
    }
    read_matrix();
    read_origin();
    read_cond();
    const std::size_t wrong_before = wrong_.size();
    read_blocks();
    if (wrong_.size() == wrong_before) {  // without blocks nothing is one a block
      read_vertices();
      read_coordinates();
    }
    read_rhs();
    if (!wrong_.empty()) throw ConfigError(wrong_);
    stored_.has_side_car = true;
    stored_.rhs_source = "side-car";
  }

 private:
  void complain(const std::string& pointer, std::string found, std::string allowed) {
    wrong_.push_back({path_ + "#" + pointer, std::move(found), std::move(allowed)});
  }
  const json* find(const char* key) const { return json_.contains(key) ? &json_[key] : nullptr; }

  void read_matrix() {
    const json* matrix = find("matrix");
    if (!matrix) return;
    if (!matrix->is_object()) return complain("/matrix", shown(*matrix), "an object");
    const auto same = [&](const char* key, const json& is, const char* of) {
      if (matrix->contains(key) && (*matrix)[key] != is) {
        complain(fmt::format("/matrix/{}", key), shown((*matrix)[key]), fmt::format("{}, {}", is.dump(), of));
      }
    };
    same("rows", n_, "the rows of the matrix beside it");
    same("entries", stored_.system.lower.nonZeros(), "the entries of the matrix beside it");
    same("sha256", sha256_, "the hash of the matrix beside it");
  }

  void read_text(const char* key, std::string& out) {
    const json* value = find(key);
    if (!value) return;
    if (!value->is_string()) return complain(fmt::format("/{}", key), shown(*value), "a string");
    out = value->get<std::string>();
  }

  void read_count(const char* key, int& out) {
    const json* value = find(key);
    if (value) out = integer(*value, fmt::format("/{}", key), 0, 1'000'000'000).value_or(out);
  }

  std::optional<int> integer(const json& value, const std::string& pointer, std::int64_t low,
                             std::int64_t high) {
    if (value.is_number_integer() && value.get<std::int64_t>() >= low && value.get<std::int64_t>() <= high) {
      return value.get<int>();
    }
    complain(pointer, shown(value), fmt::format("an integer from {} to {}", low, high));
    return std::nullopt;
  }

  void read_origin() {
    SystemOrigin& origin = stored_.origin;
    read_text("scene", origin.scene);
    read_text("formulation", origin.formulation);
    read_text("integrator", origin.integrator);
    read_text("cause", origin.cause);
    read_text("git_commit", origin.git_commit);
    read_text("form", origin.form);
    const auto& forms = matrix_forms();
    if (!origin.form.empty() && std::find(forms.begin(), forms.end(), origin.form) == forms.end()) {
      complain("/form", '"' + origin.form + '"', fmt::format("one of {}", fmt::join(forms, ", ")));
    }
    read_count("step", origin.step);
    read_count("iteration", origin.iteration);
    if (const json* dt = find("dt_s")) {
      if (dt->is_number() && dt->get<double>() > 0) {
        origin.dt_s = dt->get<double>();
      } else {
        complain("/dt_s", shown(*dt), "a number > 0");
      }
    }
  }

  /// The index of a word of an enum in its order.
  template <class Enum>
  Enum word(const json& of, const std::string& pointer, std::initializer_list<Enum> all) {
    std::vector<std::string_view> words;
    for (const Enum e : all) {
      words.push_back(to_string(e));
      if (of.is_string() && of.get<std::string>() == words.back()) return e;
    }
    complain(pointer, shown(of), fmt::format("one of {}", fmt::join(words, ", ")));
    return *all.begin();
  }

  double known(const json& of, const char* key, const std::string& pointer) {
    const json value = of.value(key, json(nullptr));
    if (value.is_number()) return value.get<double>();
    if (!value.is_null())
      complain(pointer + "/" + key, shown(value), "a number, or null where it is unknown");
    return kNan;
  }

  void read_cond() {
    const json* all = find("cond");
    if (!all) return;
    if (!all->is_array()) return complain("/cond", shown(*all), "an array");
    for (std::size_t i = 0; i < all->size(); ++i) {
      const json& one = (*all)[i];
      const std::string pointer = fmt::format("/cond/{}", i);
      if (!one.is_object()) {
        complain(pointer, shown(one), "an object");
        continue;
      }
      KnownCond out;
      out.scaling = word(one.value("scaling", json()), pointer + "/scaling",
                         {Scaling::none, Scaling::jacobi, Scaling::block_jacobi});
      out.status = word(one.value("status", json()), pointer + "/status",
                        {ConditionStatus::ok, ConditionStatus::lower_bound, ConditionStatus::singular,
                         ConditionStatus::not_pd, ConditionStatus::not_converged});
      out.tier = integer(one.value("tier", json()), pointer + "/tier", 0, 4).value_or(0);
      out.cond = known(one, "cond", pointer);
      out.lambda_min = known(one, "lambda_min", pointer);
      out.lambda_max = known(one, "lambda_max", pointer);
      stored_.cond.push_back(out);
    }
  }

  void read_blocks() {
    const json *size = find("block_size"), *start = find("block_start");
    std::vector<int>& out = stored_.system.block_start;
    if (size && start) return complain("/block_size", shown(*size), "one of block_size and block_start");
    if (size) {
      const std::optional<int> rows = integer(*size, "/block_size", 1, 3);
      if (!rows) return;
      if (n_ % *rows != 0)
        return complain("/block_size", shown(*size), fmt::format("a divisor of the {} rows", n_));
      out.clear();
      for (int i = 0; i <= n_; i += *rows) out.push_back(i);
    } else if (start && read_integers("block_start", *start, 0, n_, out)) {
      bool good = out.size() > 1 && out.front() == 0 && out.back() == n_;
      for (std::size_t b = 1; good && b < out.size(); ++b)
        good = out[b] > out[b - 1] && out[b] <= out[b - 1] + 3;
      if (!good) complain("/block_start", shown(*start), fmt::format("0 to {} in steps of 1 to 3", n_));
    }
  }

  void read_vertices() {
    const json* vertex = find("block_vertex");
    if (!vertex || !require_length("block_vertex", *vertex, n_blocks(), "block")) return;
    read_integers("block_vertex", *vertex, 0, std::numeric_limits<int>::max(), stored_.system.block_vertex);
  }

  std::size_t n_blocks() const { return std::max<std::size_t>(1, stored_.system.block_start.size()) - 1; }

  bool read_integers(const char* key, const json& list, std::int64_t low, std::int64_t high,
                     std::vector<int>& out) {
    out.clear();
    if (!list.is_array()) {
      complain(fmt::format("/{}", key), shown(list), "an array of integers");
      return false;
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::optional<int> value = integer(list[i], fmt::format("/{}/{}", key, i), low, high);
      if (!value) return false;
      out.push_back(*value);
    }
    return true;
  }

  bool require_length(const char* key, const json& list, std::size_t length, const char* each) {
    if (list.is_array() && list.size() == length) return true;
    complain(fmt::format("/{}", key), list.is_array() ? fmt::format("{} entries", list.size()) : shown(list),
             fmt::format("an array of {}, one a {}", length, each));
    return false;
  }

  void read_coordinates() {
    const json* list = find("coordinates_m");
    if (!list || !require_length("coordinates_m", *list, n_blocks(), "block")) return;
    for (std::size_t i = 0; i < list->size(); ++i) {
      const json& point = (*list)[i];
      const bool good = point.is_array() && point.size() == 3 &&
                        std::all_of(point.begin(), point.end(), [](const json& c) { return c.is_number(); });
      if (!good) return complain(fmt::format("/coordinates_m/{}", i), shown(point), "three numbers");
      stored_.coordinates.emplace_back(point[0].get<double>(), point[1].get<double>(),
                                       point[2].get<double>());
    }
    auto mesh = std::make_shared<BlockMesh>();
    mesh->point = stored_.coordinates;
    stored_.system.mesh = std::move(mesh);
  }

  void read_rhs() {
    const json* list = find("rhs");
    if (!list) return complain("/rhs", "nothing", fmt::format("an array of {}, one a row", n_));
    if (!require_length("rhs", *list, static_cast<std::size_t>(n_), "row of the matrix")) return;
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (!(*list)[i].is_number())
        return complain(fmt::format("/rhs/{}", i), shown((*list)[i]), "a finite number");
      stored_.rhs[static_cast<Eigen::Index>(i)] = (*list)[i].get<double>();
    }
  }

  const std::string &path_, &sha256_;
  StoredSystem& stored_;
  const Eigen::Index n_;
  json json_;
  std::vector<Violation> wrong_;
};

}  // namespace

void parse_side_car(const std::string& text, const std::string& path, const std::string& matrix_sha256,
                    StoredSystem& stored) {
  Reader(path, matrix_sha256, stored).read(text);
}

void read_side_car(const std::string& path, const std::string& matrix_sha256, StoredSystem& stored) {
  parse_side_car(read_input_file(path, side_car_file), path, matrix_sha256, stored);
}

}  // namespace bb

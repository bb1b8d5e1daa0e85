#include "experiments/config/films.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/base/record/provenance.hpp"
#include "core/model/mesh/film_file.hpp"
#include "experiments/config/film_generators.hpp"
#include "experiments/config/hashed_file.hpp"

namespace bb {
namespace {

using nlohmann::json;

Rule numbers(std::string unit) {
  Rule rule = any_number(std::move(unit));
  rule.kind = Kind::numbers;
  rule.min_size = 2;
  return rule;
}

std::vector<Parameter> rows_of_any() {
  return {
      {"start_s", any_number("s"), 0, "Time of the first frame, which is held before; added to every time."},
      {"interpolation", word({"linear", "smooth"}), "linear",
       "Between frames. linear: straight. smooth: velocities do not jump (cubic, Catmull and Rom)."}};
}

ParameterList of_files() {
  return {"",
          {{"file", text_up_to(0), no_default,
            "Path of the first of numbered mesh files, walk_0000.obj, walk_0001.obj, ...: the others are "
            "those of its "
            "folder whose names differ in the last number alone. `./bench data film` makes them of PC2, MDD, "
            "NPZ, "
            "PVD and "
            "runs."},
           {"sha256", any_text(), no_default, "Expected SHA-256 of their hashes (hex)."},
           {"frame_s", positive("s"), no_default,
            "Time from frame to frame. Left out: times_s, or times.csv beside the files."},
           {"times_s", numbers("s"), no_default, "Times of all frames, in the place of frame_s."}},
          false,
          {},
          ""};
}

ParameterList film_list(const json& film) {
  const Parameter generator{"generator", name_in([] { return film_generators().names(); }), no_default,
                            "A film generator (`bench list films`)."};
  ParameterList list = of_files();
  list.doc = "{\"generator\": NAME, parameters...} or {\"file\": PATH} of numbered mesh files.";
  list.forms = {{"generator"}, {"file"}};
  list.forms_text = "either file or generator";
  list.open = !film.contains("file");
  const bool named = film.contains("generator") && film["generator"].is_string() && !film.contains("file");
  if (!film.contains("file")) list.rows.insert(list.rows.begin(), generator);
  if (named) {
    list.rows = {generator};
    if (const FilmGenerator* made = film_generators().find(film["generator"].get<std::string>())) {
      list.rows.insert(list.rows.end(), made->parameters.begin(), made->parameters.end());
      list.open = false;
    }
  }
  for (Parameter& row : rows_of_any()) list.rows.push_back(std::move(row));
  return list;
}

void read_times(const json& object, const std::string& pointer, const Reader& reader, FilmSource& film) {
  if (object.contains("frame_s")) film.frame_time = object["frame_s"].get<double>();
  if (object.contains("times_s")) film.times = object["times_s"].get<std::vector<double>>();
  if (film.frame_time && !film.times.empty()) {
    return reader.complain(pointer + "/frame_s", "frame_s beside times_s", "one of both");
  }
  if (film.frame_time || !film.times.empty()) return;
  film.times_file.path = film_times_file(film.files.front().path);
  if (film.times_file.path.empty()) {
    return reader.missing(pointer + "/frame_s",
                          "frame_s, a number > 0 (s), or times_s, or a file times.csv beside the frames");
  }
  film.times_file.sha256 = hash_of(film.times_file.path, mesh_file, pointer + "/file", reader);
}

void read_files(const json& object, const std::string& pointer, const Reader& reader, FilmSource& film) {
  std::vector<std::string> files;
  try {
    files = film_files(object["file"].get<std::string>());
  } catch (const ConfigError& error) {
    for (const Violation& wrong : error.violations()) {
      reader.complain(pointer + "/file", wrong.where + ": " + wrong.found, wrong.allowed);
    }
    return;
  }
  std::string hashes;
  for (const std::string& file : files) {
    film.files.push_back({file, hash_of(file, mesh_file, pointer + "/file", reader)});
    hashes += film.files.back().sha256 + "\n";
  }
  read_times(object, pointer, reader, film);
  film.sha256 = sha256_hex(hashes + film.times_file.sha256);
  if (object.contains("sha256") && object["sha256"] != film.sha256) {
    reader.complain(pointer + "/sha256", object["sha256"].dump(),
                    "\"" + film.sha256 + "\", the hash of the files' hashes");
  }
}

std::vector<double> times_of(const FilmSource& film, std::size_t n, const std::string& where) {
  std::vector<double> out = film.times;
  std::string named = where + "/times_s";
  if (!film.times_file.path.empty()) {
    named = film.times_file.path;
    out = parse_film_times(unchanged(film.times_file, mesh_file), named);
  }
  for (std::size_t k = 0; film.frame_time && k < n; ++k)
    out.push_back(static_cast<double>(k) * *film.frame_time);
  if (out.size() != n) {
    throw ConfigError(named, fmt::format("{} times", out.size()), fmt::format("{}, one a frame", n));
  }
  for (std::size_t k = 1; k < n; ++k) {
    if (out[k] > out[k - 1]) continue;
    throw ConfigError(named, fmt::format("the time {} of frame {} after {}", out[k], k, out[k - 1]),
                      "times that increase (s)");
  }
  for (double& t : out) t += film.start;
  return out;
}

}  // namespace

Rule film_rule() {
  Rule rule;
  rule.kind = Kind::object;
  rule.list = film_list;
  return rule;
}

json film_json(const FilmSource& film) {
  if (!film.given()) return {};
  json out = film.generator.empty() ? json::object() : to_json(film.parameters);
  if (film.generator.empty()) {
    out = {{"file", film.files.front().path}, {"sha256", film.sha256}};
    if (film.frame_time) out["frame_s"] = *film.frame_time;
    if (!film.times.empty()) out["times_s"] = film.times;
  } else {
    out["generator"] = film.generator;
  }
  out["start_s"] = film.start;
  out["interpolation"] = word_of(film.between);
  return out;
}

void read_film(const json& object, const std::string& pointer, const Reader& reader, FilmSource& film) {
  if (object.contains("file") == object.contains("generator")) return;  // none, or complained of by the check
  film.start = object.value("start_s", 0.0);
  film.between = object.value("interpolation", "linear") == "smooth" ? FilmInterpolation::smooth
                                                                     : FilmInterpolation::linear;
  if (object.contains("file")) return read_files(object, pointer, reader, film);
  film.generator = object["generator"].get<std::string>();
  film.parameters = to_map(film_generators().require(film.generator, pointer).parameters, object);
}

std::shared_ptr<const Film> make_film(const FilmSource& film, const TriangleMesh& mesh,
                                      const std::function<void(Positions&)>& transform,
                                      const std::string& where) {
  if (!film.given()) return nullptr;
  std::vector<Positions> frames;
  std::vector<double> times;
  if (film.generator.empty()) {
    for (const HashedFile& file : film.files) {
      frames.push_back(parse_film_frame(unchanged(file, mesh_file), file.path, mesh));
    }
    times = times_of(film, frames.size(), where);
  } else {
    const FilmGenerator& made = film_generators().require(film.generator, where);
    const int n = integer(film.parameters, "n_frames");
    for (int k = 0; k < n; ++k) {
      const double t = number(film.parameters, "duration_s") * k / (n - 1);
      try {
        frames.push_back(made.pose(mesh.vertices, film.parameters, t));
      } catch (const ConfigError& error) {
        const Violation& wrong = error.violations().front();
        throw ConfigError(where + "/" + wrong.where, wrong.found, wrong.allowed);
      }
      times.push_back(t + film.start);
    }
  }
  for (Positions& frame : frames) transform(frame);
  return std::make_shared<const Film>(std::move(times), std::move(frames), film.between);
}

}  // namespace bb

#include "experiments/run/artifacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/write_mesh.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "experiments/matrix/matrix_market.hpp"
#include "experiments/run/keep_record.hpp"
#include "experiments/run/scene_json.hpp"

namespace bb {

namespace {

using nlohmann::json;

json framed_json(const Obstacle& o) {
  json out = obstacle_json(o);
  if (o.vertex >= 0) out["vertex"] = o.vertex;  // of the frames: where point_m is there
  return out;
}

std::string scene_json(const Scene& scene) {
  json out = {{"planar", scene.planar}, {"bodies", json::array()}, {"obstacles", json::array()}};
  const auto is_obstacle = [&scene](const Body& body) {
    return std::any_of(scene.obstacles.begin(), scene.obstacles.end(),
                       [&body](const Obstacle& o) { return o.vertex == body.first_vertex; });
  };
  for (const Body& body : scene.bodies) {
    if (!is_obstacle(body)) out["bodies"].push_back(body.name);
  }
  for (const Obstacle& obstacle : scene.obstacles) out["obstacles"].push_back(framed_json(obstacle));
  return out.dump(2) + "\n";
}

}  // namespace

// The file of the record stays as it is whatever becomes of the copy. Errors: RecordError.
static void write_copy(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  make_folder(to.parent_path());
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
  if (error) fail_with(to, "cannot copy", error.value());
}

ContactFields contact_fields(const ContactState& state, int n_vertices) {
  const auto n = static_cast<std::size_t>(n_vertices);
  ContactFields fields{std::vector<double>(n, 1.0), std::vector<double>(n, 0.0), std::nullopt, std::nullopt};
  const auto gather = [&fields](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (const int id : rows.key(r)) {  // prescribed vertices included; an obstacle is negative
        if (id < 0) continue;
        double& gap = fields.gap_rel[static_cast<std::size_t>(id)];
        gap = std::min(gap, rows.d[r] / rows.d_hat[r]);
      }
    }
  };
  gather(state.rows);
  gather(state.mollified);
  const auto add_load = [&fields](const auto& rows, const std::vector<int>& vertex) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double force = -rows.force(r);
      for (std::size_t k = 4 * r; k < 4 * r + 4; ++k) {
        if (vertex[k] >= 0)
          fields.load[static_cast<std::size_t>(vertex[k])] += std::abs(rows.weight[k]) * force;
      }
    }
  };
  add_load(state.rows, state.rows.vertex);
  return fields;
}

Positions vertex_forces(const std::vector<ContactForce>& rows, int n_vertices, bool friction) {
  Positions out = Positions::Zero(3, n_vertices);
  for (const ContactForce& row : rows) {
    if ((row.term == "friction") != friction) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      if (row.vertex[k] >= 0) out.col(row.vertex[k]) += row.force[k];
    }
  }
  return out;
}

ArtifactWriter::ArtifactWriter(std::filesystem::path folder, const Scene& scene)
    : folder_(std::move(folder)), scene_(scene), rods_(lone_edges(scene)) {
  for (const auto& t : scene.surface_triangles) {
    triangle_body_.push_back(scene.body[static_cast<std::size_t>(t[0])]);
  }
}

// Of vertices, N.
static void add_vector(std::vector<PlyColumn>& columns, const std::string& name, const Positions& of) {
  for (int c = 0; c < 3; ++c) {
    const VecXd part = of.row(c);
    columns.push_back({name + "_" + "xyz"[c] + "_N", std::vector<double>(part.begin(), part.end())});
  }
}

ArtifactWriter::~ArtifactWriter() {
  if (!leave_) remove_unfinished_artifacts(folder_);
}

void ArtifactWriter::keep(Archive& archive) {
  archive.grown("artifacts", written_);
  if (!archive.reads()) return;
  leave_ = true;  // what is refused here is not lost
  for (const Artifact& file : written_) {
    const std::filesystem::path path = folder_ / part_of(file.path), recorded = folder_ / file.path;
    const std::string found = sha256_file(path.string());
    if (found == file.sha256) continue;
    if (sha256_file(recorded.string()) == file.sha256) {  // of a run that was recorded when it was cut off
      write_copy(recorded, path);
      continue;
    }
    throw ConfigError(path.string(), found.empty() ? "not there" : "sha256 " + found.substr(0, 16),
                      "sha256 " + file.sha256.substr(0, 16) + ", as the checkpoint has it, or no --resume");
  }
}

void ArtifactWriter::start() {
  write("frames/scene.json", scene_json(scene_), "frame_scene", "application/json");
  write_frame("frames/start.ply", scene_.x0, nullptr);
}

void ArtifactWriter::frame(const Positions& x, int step, const ContactFields& fields) {
  write_frame(fmt::format("frames/step_{:06}.ply", step), x, &fields);
}

void ArtifactWriter::write_frame(const std::filesystem::path& relative, const Positions& x,
                                 const ContactFields* fields) {
  TriangleMesh mesh;
  mesh.vertices = x;
  mesh.triangles = scene_.surface_triangles;
  mesh.segments = rods_;
  std::vector<PlyColumn> of_vertices{{"body", scene_.body}};
  if (fields) {
    of_vertices.push_back({"gap_rel", fields->gap_rel});
    of_vertices.push_back({"load_N", fields->load});
    if (fields->contact) add_vector(of_vertices, "contact", *fields->contact);
    if (fields->friction) add_vector(of_vertices, "friction", *fields->friction);
  }
  FrameFields columns{std::move(of_vertices), {{"body", triangle_body_}}};
  for (const PartEntry& entry : part_entries()) entry.part.add_frame_fields(scene_, x, columns);
  write(relative, ply_bytes(mesh, columns.of_vertices, columns.of_triangles), "frame", "model/ply");
}

void ArtifactWriter::matrix(const StoredSystem& stored) {
  const SystemOrigin& origin = stored.origin;
  const std::string name = fmt::format("step_{:06}_iteration_{:03}{}", origin.step, origin.iteration,
                                       origin.form == "exact" ? "_exact" : "");
  const std::string text = matrix_market_text(stored.system.lower);
  write("matrices/" + name + ".mtx", text, "matrix", "text/x-matrix-market");
  write("matrices/" + name + ".json", side_car_text(stored, name + ".mtx", text), "matrix_side_car",
        "application/json");
}

void ArtifactWriter::pair_forces(const std::string& csv) {
  write("forces/pairs.csv", csv, "pair_forces", "text/csv");
}

void ArtifactWriter::drop_matrices(int step) {
  const std::string begin = fmt::format("matrices/step_{:06}_", step);
  std::erase_if(written_, [&](const Artifact& file) {
    if (!file.path.starts_with(begin)) return false;
    std::error_code error;
    std::filesystem::remove(folder_ / part_of(file.path), error);
    return true;
  });
}

void ArtifactWriter::write(const std::filesystem::path& relative, const std::string& bytes, const char* kind,
                           const char* media_type) {
  write_atomically(folder_ / part_of(relative), bytes);
  Artifact artifact;
  artifact.path = relative.generic_string();
  artifact.kind = kind;
  artifact.media_type = media_type;
  artifact.sha256 = sha256_hex(bytes);
  artifact.bytes = bytes.size();
  // an attempt at a step that is repeated has left files of the same names
  std::erase_if(written_, [&artifact](const Artifact& earlier) { return earlier.path == artifact.path; });
  written_.push_back(std::move(artifact));
}

}  // namespace bb

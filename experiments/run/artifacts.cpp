#include "experiments/run/artifacts.hpp"

#include <fmt/format.h>

#include "core/mesh/write_mesh.hpp"
#include "core/record/provenance.hpp"
#include "core/record/writer.hpp"

namespace bb {

ArtifactWriter::ArtifactWriter(std::filesystem::path folder, const Scene& scene)
    : folder_(std::move(folder)), scene_(scene) {}

void ArtifactWriter::frame(const Positions& x, int step) {
  const std::filesystem::path relative = fmt::format("frames/step_{:06}.ply", step);
  TriangleMesh mesh;
  mesh.vertices = x;
  mesh.triangles = scene_.planar ? scene_.membrane.triangles : scene_.surface_triangles;
  if (mesh.triangles.empty()) mesh.segments = scene_.surface_edges;
  write_atomically(folder_ / relative, ply_bytes(mesh));
  keep(relative, "frame", "model/ply");
}

void ArtifactWriter::matrix(const ReducedSystem& system, int step, int iteration) {
  const std::filesystem::path relative =
      fmt::format("matrices/step_{:06}_iteration_{:03}.mtx", step, iteration);
  const Eigen::SparseMatrix<double>& a = system.lower;
  std::string text = fmt::format("%%MatrixMarket matrix coordinate real symmetric\n{} {} {}\n", a.rows(),
                                 a.cols(), a.nonZeros());
  for (Eigen::Index column = 0; column < a.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, column); it; ++it) {
      fmt::format_to(std::back_inserter(text), "{} {} {:.17g}\n", it.row() + 1, it.col() + 1, it.value());
    }
  }
  write_atomically(folder_ / relative, text);
  keep(relative, "matrix", "text/x-matrix-market");
}

void ArtifactWriter::keep(const std::filesystem::path& relative, const char* kind, const char* media_type) {
  Artifact artifact;
  artifact.path = relative.generic_string();
  artifact.kind = kind;
  artifact.media_type = media_type;
  artifact.sha256 = sha256_file((folder_ / relative).string());
  artifact.bytes = std::filesystem::file_size(folder_ / relative);
  written_.push_back(std::move(artifact));
}

}  // namespace bb

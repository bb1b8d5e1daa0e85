// The optional files of a run: frames (meshes) and Newton matrices, each named in the record with its hash.
#pragma once

#include <filesystem>
#include <vector>

#include "core/linear/block_system.hpp"
#include "core/record/run_record.hpp"
#include "core/scene/scene.hpp"

namespace bb {

class ArtifactWriter {
 public:
  ArtifactWriter(std::filesystem::path folder, const Scene& scene);
  /// frames/step_000010.ply: all surfaces and segments of the scene. Errors: RecordError when it cannot be
  /// written whole.
  void frame(const Positions& x, int step);
  /// matrices/step_000010_iteration_002.mtx: Matrix Market, symmetric, lower triangle, 17 digits.
  void matrix(const ReducedSystem& system, int step, int iteration);
  const std::vector<Artifact>& written() const { return written_; }

 private:
  void keep(const std::filesystem::path& relative, const char* kind, const char* media_type);

  std::filesystem::path folder_;
  const Scene& scene_;
  std::vector<Artifact> written_;
};

}  // namespace bb

// The optional files of a run: frames (meshes) and Newton matrices, each named in the record with its hash.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/contact/contact_forces.hpp"
#include "core/model/scene/scene.hpp"
#include "core/terms/contact.hpp"
#include "experiments/matrix/system_file.hpp"

namespace bb {

/// What contact does to each vertex in one state.
struct ContactFields {
  std::vector<double> gap_rel;  // [n vertices] smallest d/d_hat of the rows at the vertex; 1 without a row
  std::vector<double> load;     // [n vertices] N, sum of |w_i| kappa |b'| over those rows; 0 without a row
  std::optional<Positions> contact, friction;  // [3 x n vertices] N, forces on the vertex, where requested
};

/// Both fields from the rows of a state. A nearly parallel edge pair has a gap, but, as in the records, no
/// load of its own: its mollifier scales kappa |b'|.   Cost: O(vertices + rows).
ContactFields contact_fields(const ContactState& state, int n_vertices);

/// Forces of friction, or of contact with restitution, on every vertex [3 x n vertices], N; 0 where there is none.
Positions vertex_forces(const std::vector<ContactForce>& rows, int n_vertices, bool friction);

/// Files of one run below `folder`/frames, `folder`/forces and `folder`/matrices.
///
/// A frame is a binary PLY file of all bodies: triangles, and rods as edges. Every vertex has `body` (index
/// into the bodies of frames/scene.json), every triangle `body`; parts (core/model/bodies/part.hpp) add theirs: membranes `stretch`, the
/// largest singular value of its deformation gradient, minus 1. At the end of a step vertices also have `gap_rel` and `load_N`, as in
/// ContactFields; where they are requested, forces as contact_x_N, contact_y_N, contact_z_N and friction_x_N, ... Errors of every function: RecordError when a file cannot be written whole.
///
/// Files lie in frames.part, forces.part and matrices.part until put_in_place() (core/base/record/run_folder.hpp), so that those of an
/// earlier run stay with its run.json until the new run is over; a run that never finishes leaves neither.
class ArtifactWriter {
 public:
  ArtifactWriter(std::filesystem::path folder, const Scene& scene);
  ~ArtifactWriter();
  ArtifactWriter(const ArtifactWriter&) = delete;
  ArtifactWriter& operator=(const ArtifactWriter&) = delete;
  /// frames/scene.json: names of the bodies, and the analytic obstacles, which no frame repeats; and
  /// frames/start.ply: the start positions.
  void start();
  /// frames/step_000010.ply: the end of step 10; the first step is 0.
  void frame(const Positions& x, int step, const ContactFields& fields);
  /// matrices/step_000010_iteration_002.mtx and .json, the side-car; "_exact" before the dot for the form of
  /// that name.
  void matrix(const StoredSystem& stored);
  const std::vector<Artifact>& written() const { return written_; }
  /// forces/pairs.csv with this text, once.
  void pair_forces(const std::string& csv);
  /// The names of what was written so far. Reading requires that the files are there. Errors: ConfigError naming one
  /// that is not, or has another size.
  void keep(Archive& archive);
  /// From now on the files stay, also those of a run that never finishes: a checkpoint or a record names them.
  void leave_unfinished() { leave_ = true; }
  /// The step begins again: the matrices of its attempt are no part of the run.
  void drop_matrices(int step);

 private:
  void write_frame(const std::filesystem::path& relative, const Positions& x, const ContactFields* fields);
  void write(const std::filesystem::path& relative, const std::string& bytes, const char* kind,
             const char* media_type);

  std::filesystem::path folder_;
  const Scene& scene_;
  std::vector<std::array<int, 2>> rods_;  // edges of the surface that belong to no triangle
  std::vector<int> triangle_body_;
  std::vector<Artifact> written_;
  bool leave_ = false;
};

}  // namespace bb

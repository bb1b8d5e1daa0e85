// Where terms with stencils that stay add up: the pattern of all of them, the values of their matrix, and for each family of
// elements what gathers its local terms.
#pragma once

#include <algorithm>
#include <vector>

#include "core/linear/executor/executor_matrix.hpp"
#include "core/terms/executor/gather_lists.hpp"

namespace bb::exec {

class ElementMatrix {
 public:
  /// Elements that have local terms at a time: 90 numbers of an element of four vertices, so 180 MiB.
  static constexpr Index default_piece = Index{1} << 18;

  /// Results do not depend on `piece`.
  ElementMatrix(Executor& executor, int n_vertices, Index piece = default_piece);

  // --- once: all families, then finish()
  /// vertices: [width n] element-major. Returns the number of the family.
  std::size_t add_family(int width, std::vector<int> vertices);
  /// Errors: those of block_rows and GatherLists; OutOfMemory.
  void finish();

  // --- the matrix: clear(), what terms add to the lower triangle, mirror()
  void clear() { value_.fill_zero(); }
  void mirror();
  /// Both triangles, prescribed vertices included.
  MatrixPart part() const { return {row_begin_.data(), column_.data(), value_.data()}; }
  double* value() { return value_.data(); }
  Index n_blocks() const { return column_.size(); }
  Index n_vertices() const { return n_vertices_; }

  // --- local terms of a family: local(piece, numbers) fills them, [3 width, piece.n] or [lower numbers, piece.n]
  /// g [3 n_vertices] (N) += its gradients.
  template <class F>
  void add_gradients(std::size_t family, double* g, const F& local) {
    for_each_piece(family, [&](const Piece& piece, const GatherLists& gathers) {
      local(piece, local_.data());
      gathers.add_gradients(executor_, piece.n, local_.data(), g);
    });
  }
  template <class F>
  void add_hessians(std::size_t family, const F& local) {
    for_each_piece(family, [&](const Piece& piece, const GatherLists& gathers) {
      local(piece, local_.data());
      gathers.add_hessians(executor_, piece.n, local_.data(), value_.data());
    });
  }

 private:
  struct Family {
    int width;
    Index size;
    std::vector<int> vertices;         // until finish()
    std::vector<GatherLists> gathers;  // one a piece
  };
  template <class F>
  void for_each_piece(std::size_t family, const F& f) const {
    const Family& of = families_[family];
    for (std::size_t i = 0; i < of.gathers.size(); ++i) {
      const Index begin = static_cast<Index>(i) * piece_;
      f(Piece{begin, std::min(piece_, of.size - begin)}, of.gathers[i]);
    }
  }

  /// Which block above the diagonal is the transpose of which one below: it stays, so no kernel searches for it.
  void list_mirrored(const BlockRows& rows);

  Executor& executor_;
  Index n_vertices_, piece_;
  std::vector<Family> families_;
  Buffer<Index> row_begin_;
  Buffer<int> column_;
  Buffer<std::uint32_t> mirror_to_, mirror_from_;
  Buffer<double> value_;
  Buffer<double> local_;  // gradients or Hessians of a piece
};

}  // namespace bb::exec

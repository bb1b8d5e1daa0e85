#include "core/linear/executor/reduced_upload.hpp"

#include "core/math/at.hpp"
#include "core/math/parallel.hpp"

namespace bb::exec {
UploadedSystem::UploadedSystem(Executor& executor)
    : row_begin_(executor, "matrix rows"),
      column_(executor, "matrix columns"),
      value_(executor, "matrix values"),
      fixed_(executor, "fixed degrees of freedom") {}

void UploadedSystem::update_pattern() {
  const std::vector<int>& start = rows_.start();
  std::vector<FixedMask> fixed(at(rows_.n_blocks()));
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    fixed[v] = static_cast<FixedMask>(7 & 7 << (start[v + 1] - start[v]));
  }
  fixed_.upload(fixed);
  row_begin_.upload(std::vector<Index>(rows_.row_start().begin(), rows_.row_start().end()));
  column_.upload(rows_.column());
  packed_.assign(at(value_count(column_.size())), 0.0);
}

void UploadedSystem::update(const ReducedSystem& system) {
  rows_.update(system);
  if (!key_.same_as_last(system)) {
    key_.forget();
    update_pattern();
    key_.same_as_last(system);
  }
  parallel_items(column_.size(), 4096, [&](Index j) {
    const double* block = rows_.block(static_cast<int>(j));
    for (int c = 0; c < 9; ++c) packed_[at(value_index(j, c))] = block[3 * (c % 3) + c / 3];
  });
  value_.upload(packed_);
}

void UploadedSystem::upload(const VecXd& b, Buffer<double>& full) const {
  std::vector<double> out(at(3 * n_vertices()), 0.0);
  for (std::size_t v = 0; v + 1 < rows_.start().size(); ++v) {
    for (int i = rows_.start()[v]; i < rows_.start()[v + 1]; ++i) {
      out[3 * v + at(i - rows_.start()[v])] = b[i];
    }
  }
  full.upload(out);
}

void UploadedSystem::download(const Buffer<double>& full, VecXd& x) const {
  const std::vector<double> from = full.download();
  x.resize(rows_.n());
  for (std::size_t v = 0; v + 1 < rows_.start().size(); ++v) {
    for (int i = rows_.start()[v]; i < rows_.start()[v + 1]; ++i) {
      x[i] = from[3 * v + at(i - rows_.start()[v])];
    }
  }
}

}  // namespace bb::exec

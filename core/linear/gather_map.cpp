// A counting sort by column, then a small sort by row inside each column. The number of the contribution is
// the lower half of the key, so equal rows stay in element order.
#include "core/linear/gather_map.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"
#include "core/math/error.hpp"
#include "core/math/lanes.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb {
namespace {

int row_of(std::uint64_t key) { return static_cast<int>(key >> 32); }
constexpr int columns_a_task = 256;  // columns a task: some thousand contributions

using Four = VectorOf<double, 4>::type;
using FourBits = LaneMask<double, 4>::Bits;

/// Contributions between a prefetch and its use: what a line from memory takes to come.
constexpr std::size_t prefetch_distance = 48;
/// Local Hessians from this size on are prefetched: smaller ones are still in a cache, where it costs more than it saves.
constexpr std::size_t prefetched_bytes = std::size_t{8} << 20;

constexpr FourBits transposed_lanes[2] = {{0, 0, 0, 0}, {-1, -1, -1, -1}};

Four load_four(const double* from) {
  Four out;
  std::memcpy(&out, from, sizeof(out));
  return out;
}

/// A 3x3 block, column-major: entries 0 to 3, 4 to 7, and 8.
struct Block {
  Four low, high;
  double last;
};
Block load_block(const double* from) { return {load_four(from), load_four(from + 4), from[8]}; }

/// Of local Hessians that stand alone.
struct AloneBlocks {
  const double* from;
  explicit AloneBlocks(std::span<const double> hess) : from(hess.data()) {}
  explicit AloneBlocks(const LocalHessians& hess) : AloneBlocks(hess.from) {}
  Block at(std::size_t offset) const { return load_block(from + offset); }
  void prefetch(std::size_t offset) const {
    __builtin_prefetch(from + offset);
    __builtin_prefetch(from + offset + 8);
  }
};
/// Of those between two, as LocalHessians has each number.
struct BlendedBlocks {
  AloneBlocks from, to;
  double t;
  explicit BlendedBlocks(const LocalHessians& hess) : from(hess.from), to(hess.to), t(hess.t) {}
  Block at(std::size_t offset) const {
    const Block a = from.at(offset), b = to.at(offset);
    return {a.low + t * (b.low - a.low), a.high + t * (b.high - a.high), a.last + t * (b.last - a.last)};
  }
  void prefetch(std::size_t offset) const {
    from.prefetch(offset);
    to.prefetch(offset);
  }
};

/// The sum of a target.
struct BlockSum {
  Four low, high;
  double last;

  explicit BlockSum(const double* block)
      : low(load_four(block)), high(load_four(block + 4)), last(block[8]) {}
  void add(const Block& block) {
    low += block.low;
    high += block.high;
    last += block.last;
  }
  /// The block or its transpose, without a branch: the orientation is not predictable.
  void add(const Block& block, bool transposed) {
    const Four a = block.low, b = block.high;
    const Four transposed_low = __builtin_shufflevector(a, b, 0, 3, 6, 1);
    const Four transposed_high = __builtin_shufflevector(a, b, 4, 7, 2, 5);
    const FourBits lanes = transposed_lanes[transposed ? 1 : 0];
    low += lanes ? transposed_low : a;
    high += lanes ? transposed_high : b;
    last += block.last;
  }
  void store(double* block) const {
    std::memcpy(block, &low, sizeof(low));
    std::memcpy(block + 4, &high, sizeof(high));
    block[8] = last;
  }
};

/// Turns counts shifted by one, [n + 1], into starts.
void prefix_sum(std::vector<std::size_t>& start) {
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
}

}  // namespace

bool GatherMap::same(const Stencils& stencils) const {
  return stencils.width == width_ &&
         std::equal(vertices_.begin(), vertices_.end(), stencils.vertices.begin(), stencils.vertices.end());
}

void GatherMap::check(const Stencils& stencils, int n_vertices) const {
  const std::size_t w = at(stencils.width);
  if (stencils.width < 0 || (w == 0 && !stencils.vertices.empty()) ||
      (w > 0 && stencils.vertices.size() % w != 0)) {
    throw ConfigError("Stencils", "width " + std::to_string(stencils.width), "a divisor of the vertex count");
  }
  for (const int v : stencils.vertices) {
    if (v < -1 || v >= n_vertices) {
      throw ConfigError("Stencils", "vertex " + std::to_string(v), "-1 to n_vertices - 1");
    }
  }
  if (stencils.size() * w * (w + 1) > std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("Stencils", std::to_string(stencils.size()) + " elements",
                      "2^31 lower blocks in a family");
  }
}

void GatherMap::build(const Stencils& stencils, int n_vertices) {
  check(stencils, n_vertices);
  width_ = stencils.width;
  vertices_.assign(stencils.vertices.begin(), stencils.vertices.end());
  sort_contributions(n_vertices);
  write_targets(n_vertices);
  build_gradient_map(n_vertices);
}

void GatherMap::sort_contributions(int n_vertices) {
  // Every ordered pair (a, b) of local vertices with vertex[a] >= vertex[b] is one lower
  // contribution. A vertex that occurs twice gives both orders to its diagonal block, as the sum of
  // the local Hessian demands.
  const auto for_each_pair = [this](const auto& f) {
    for (std::size_t e = 0, n = n_elements(), w = at(width_); e < n; ++e) {
      const int* v = vertices_.data() + e * w;
      for (std::size_t b = 0; b < w; ++b) {
        if (v[b] < 0) continue;
        for (std::size_t a = 0; a < w; ++a) {
          if (v[a] >= v[b]) f(v[a], v[b], (e * w + b) * w + a);
        }
      }
    }
  };
  key_start_.assign(at(n_vertices) + 1, 0);
  for_each_pair([this](int, int column, std::size_t) { ++key_start_[at(column) + 1]; });
  prefix_sum(key_start_);
  key_.resize(key_start_.back());
  cursor_.assign(key_start_.begin(), key_start_.end() - 1);
  for_each_pair([this](int row, int column, std::size_t number) {
    key_[cursor_[at(column)]++] = static_cast<std::uint64_t>(row) << 32 | number;
  });
  parallel_items(n_vertices, columns_a_task, [this](int c) {
    std::sort(key_.data() + key_start_[at(c)], key_.data() + key_start_[at(c) + 1]);
  });
}

void GatherMap::write_targets(int n_vertices) {
  const auto first_of_row = [this](std::size_t begin, std::size_t k) {
    return k == begin || row_of(key_[k]) != row_of(key_[k - 1]);
  };
  column_start_.resize(at(n_vertices) + 1);
  column_start_[0] = 0;
  parallel_items(n_vertices, columns_a_task, [&](int c) {
    const std::size_t begin = key_start_[at(c)], end = key_start_[at(c) + 1];
    int n = 0;
    for (std::size_t k = begin; k < end; ++k) n += first_of_row(begin, k);
    column_start_[at(c) + 1] = n;
  });
  for (std::size_t c = 1; c < column_start_.size(); ++c) column_start_[c] += column_start_[c - 1];
  const std::size_t n_targets = at(column_start_.back());
  row_.resize(n_targets);
  block_.resize(n_targets);
  mixed_.assign(n_targets, 0);
  source_start_.resize(n_targets + 1);
  source_start_[n_targets] = static_cast<std::uint32_t>(key_.size());
  source_.resize(key_.size());
  const std::size_t w = at(width_);
  parallel_items(n_vertices, columns_a_task, [&](int c) {
    const std::size_t begin = key_start_[at(c)], end = key_start_[at(c) + 1];
    std::size_t target = at(column_start_[at(c)]);
    for (std::size_t k = begin; k < end; ++k) {
      if (first_of_row(begin, k)) {
        row_[target] = row_of(key_[k]);
        source_start_[target++] = static_cast<std::uint32_t>(k);
      }
      const std::size_t number = key_[k] & 0xffffffffu, e = number / (w * w), ab = number % (w * w);
      const std::size_t a = ab % w, b = ab / w;
      const std::size_t block = n_lower_blocks(w) * e + lower_block(w, std::max(a, b), std::min(a, b));
      source_[k] = static_cast<std::uint32_t>(2 * block + (a < b ? 1 : 0));
      if (a < b) mixed_[target - 1] = 1;
    }
  });
}

void GatherMap::build_gradient_map(int n_vertices) {
  vertex_start_.assign(at(n_vertices) + 1, 0);
  for (const int v : vertices_) {
    if (v >= 0) ++vertex_start_[at(v) + 1];
  }
  prefix_sum(vertex_start_);
  vertex_source_.resize(vertex_start_.back());
  cursor_.assign(vertex_start_.begin(), vertex_start_.end() - 1);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (vertices_[i] >= 0) vertex_source_[cursor_[at(vertices_[i])]++] = 3 * i;
  }
}

void GatherMap::place(const BlockPattern& pattern) {
  parallel_items(pattern.n_vertices(), columns_a_task, [&](int c) {
    int block = pattern.column_start[at(c)];
    for (int t = column_start_[at(c)]; t < column_start_[at(c) + 1]; ++t) {
      while (pattern.row[at(block)] < row_[at(t)]) ++block;
      block_[at(t)] = block;
    }
  });
}

void GatherMap::add_hessians(const LocalHessians& hess, std::vector<double>& values) const {
  const bool blended = !hess.to.empty();
  if (hess.from.size() != n_elements() * n_lower_numbers(at(width_))) {
    throw ConfigError("local Hessians", std::to_string(hess.from.size()) + " numbers",
                      "size * 9 width (width + 1)/2");
  }
  const bool ahead = hess.from.size_bytes() + hess.to.size_bytes() >= prefetched_bytes;
  const auto add = blended ? (ahead ? &GatherMap::add_targets<BlendedBlocks, true>
                                    : &GatherMap::add_targets<BlendedBlocks, false>)
                           : (ahead ? &GatherMap::add_targets<AloneBlocks, true>
                                    : &GatherMap::add_targets<AloneBlocks, false>);
  (this->*add)(hess, values.data());
}

template <class Blocks, bool Ahead>
void GatherMap::add_targets(const LocalHessians& hess, double* values) const {
  // Copies: behind a reference every store to `values` might change them.
  const std::uint32_t *const sources = source_.data(), *const starts = source_start_.data();
  const std::size_t last = source_.size() - 1;
  const std::uint8_t* const mixed = mixed_.data();
  const int* const targets = block_.data();
  const Blocks blocks(hess);
  parallel_blocks(row_.size(), [=](std::size_t, std::size_t first, std::size_t beyond) {
    // In line: a block that is handed over in memory costs a third more than its sum.
    const auto source = [=](std::size_t k) __attribute__((always_inline)) {
      if constexpr (Ahead)
        blocks.prefetch(9 * std::size_t{sources[std::min(k + prefetch_distance, last)] / 2});
      return blocks.at(9 * std::size_t{sources[k] / 2});
    };
    for (std::size_t t = first; t < beyond; ++t) {
      double* const out = values + 9 * at(targets[t]);
      const std::size_t begin = starts[t], end = starts[t + 1];
      BlockSum sum(out);
      if (mixed[t]) {
        for (std::size_t k = begin; k < end; ++k) sum.add(source(k), sources[k] % 2 != 0);
      } else {
        for (std::size_t k = begin; k < end; ++k) sum.add(source(k));
      }
      sum.store(out);
    }
  });
}

void GatherMap::add_gradients(std::span<const double> grad, PositionsSpan g) const {
  if (grad.size() != 3 * vertices_.size()) {
    throw ConfigError("local gradients", std::to_string(grad.size()) + " numbers", "size * 3 width");
  }
  if (vertices_.empty()) return;
  parallel_items(static_cast<int>(g.cols()), 1024, [&](int v) {
    for (std::size_t k = vertex_start_[at(v)]; k < vertex_start_[at(v) + 1]; ++k) {
      g.col(v) += Eigen::Map<const Vec3d>(grad.data() + vertex_source_[k]);
    }
  });
}

}  // namespace bb

// Sums over rows and vectors: trees that are a function of the number of items alone.
#pragma once

#include "core/resident/contact/gather_kernels.hpp"

namespace bb::resident {

/// A sum with what rounding took from it, and the sum of the magnitudes of its items.
struct CompensatedSum {
  double sum, lost, magnitude;
  BB_HD double value() const { return sum + lost; }
};

/// Knuth 1969, two-sum.
BB_HD inline CompensatedSum operator+(const CompensatedSum& a, const CompensatedSum& b) {
  const double sum = a.sum + b.sum, of_b = sum - a.sum;
  const double lost = (a.sum - (sum - of_b)) + (b.sum - of_b);
  return {sum, a.lost + b.lost + lost, a.magnitude + b.magnitude};
}

/// out[b]: the sum of item(i) over the 256 items of block b.
template <class Item>
struct SumItems {
  Item item;
  Index n;
  CompensatedSum* out;
  struct Shared {
    CompensatedSum part[exec::block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    CompensatedSum* const part = shared.part;
    const SumItems k = *this;
    block.threads([=](int t) {
      const Index i = b * exec::block_threads + t;
      const double x = i < k.n ? k.item(i) : 0.0;
      part[t] = {x, 0.0, x < 0 ? -x : x};
    });
    exec::fold(block, part, exec::block_threads);
    block.threads([=](int t) {
      if (t == 0) k.out[b] = part[0];
    });
  }
};

/// The same over sums.
struct FoldSums {
  const CompensatedSum* in;
  Index n;
  CompensatedSum* out;
  struct Shared {
    CompensatedSum part[exec::block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    CompensatedSum* const part = shared.part;
    const FoldSums k = *this;
    block.threads([=](int t) {
      const Index i = b * exec::block_threads + t;
      part[t] = i < k.n ? k.in[i] : CompensatedSum{0, 0, 0};
    });
    exec::fold(block, part, exec::block_threads);
    block.threads([=](int t) {
      if (t == 0) k.out[b] = part[0];
    });
  }
};

/// Energy of a row, J, mollifier included.
struct RowEnergy {
  RowView rows;
  MollifiedColumn mollifier;  // [n], one number each
  BB_HD double operator()(Index r) const {
    const double e = rows.energy[r];
    return rows.mollified(r) ? mollifier.number[mollifier.of(r)] * e : e;
  }
};

/// a_i b_i over the degrees of freedom whose bit is not set: 3 bits a vertex.
struct FreeProduct {
  const double *a, *b;
  const std::uint8_t* fixed;  // [n_vertices]
  BB_HD double operator()(Index i) const { return (fixed[i / 3] >> (i % 3) & 1) != 0 ? 0.0 : a[i] * b[i]; }
};

/// Mass of the free vertices of a row, kg, and how many they are.
struct RowMass {
  RowView rows;
  const double* mass;
  BB_HD double operator()(Index r) const {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (rows.is_free(r, k)) sum += mass[rows.vertex[k * rows.n + r]];
    }
    return sum;
  }
};
struct RowPoints {
  RowView rows;
  BB_HD double operator()(Index r) const { return rows.n_free(r); }
};

}  // namespace bb::resident

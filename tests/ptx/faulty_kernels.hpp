// Kernels that break a rule of core/exec/kernel.hpp: the checked run time has to say so.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::faulty {

using exec::Index;

struct OneTooFar {
  double* out;
  BB_HD void operator()(Index i) const { out[i + 1] = 1; }
};
struct ReadsBefore {
  const double* in;
  double* out;
  BB_HD void operator()(Index i) const { out[i] = in[i - 1]; }
};
struct Misaligned {
  unsigned char* out;
  BB_HD void operator()(Index i) const { *reinterpret_cast<double*>(out + 8 * i + 4) = 1; }
};
struct Endless {
  const double* in;
  double* out;
  BB_HD void operator()(Index i) const {
    double x = 0;
    while (x < in[0]) x = x * in[1];
    out[i] = x;
  }
};
/// Reads what another thread wrote without a barrier.
struct MissingBarrier {
  struct Shared {
    double a[256];
  };
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) {
      shared.a[t] = t;
      out[256 * b + t] = shared.a[(t + 1) % 256];
    });
  }
};
struct WritesTogether {
  struct Shared {
    double a[2];
  };
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) { shared.a[t & 1] = t; });
    block.threads([&](int t) { out[256 * b + t] = shared.a[0]; });
  }
};
/// In place: the neighbour may have been there before.
struct ReadsNeighbour {
  double* x;
  Index n;
  BB_HD void operator()(Index i) const { x[i] = x[(i + 1) % n] + 1; }
};
struct AllWriteOne {
  double* out;
  BB_HD void operator()(Index i) const { out[0] = static_cast<double>(i); }
};
/// As ReadsNeighbour, one thread a block.
struct ReadsNextBlock {
  struct Shared {
    int unused;
  };
  double* x;
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
    block.threads([&](int t) {
      if (t == 0) x[b] = x[b] + x[b + 1];
    });
  }
};
/// What it reads depends on how many came before.
struct ReadsACounter {
  struct Shared {
    int unused;
  };
  std::uint32_t *counter, *out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
    block.threads([&](int t) {
      if (t > 0) return;
#ifdef __CUDA_ARCH__
      atomicAdd(counter, 1u);
#endif
      out[b] = *counter;
    });
  }
};
/// Two blocks read a word, the second one writes it behind a barrier of its own.
struct WritesWhatAnotherBlockRead {
  struct Shared {
    double sum;
  };
  double *x, *out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) {
      if (t == 0) shared.sum = x[0];
    });
    block.threads([&](int t) {
      if (t == 0) out[b] = shared.sum + x[0];
    });
    block.threads([&](int t) {
      if (t == 1 && b == 1) x[0] = 2;
    });
  }
};
/// The last block reads what all wrote. Whether it sees it is a matter of the fence.
struct LastBlockReads {
  struct Shared {
    bool last;
  };
  double* part;
  std::uint32_t* ended;
  Index n;
  bool with_fence;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) {
      if (t == 0) part[b] = static_cast<double>(b);
#ifdef __CUDA_ARCH__
      if (t == 0 && with_fence) __threadfence();
      if (t == 0) shared.last = atomicAdd(ended, 1u) + 1 == static_cast<std::uint32_t>(n);
#endif
    });
    block.threads([&](int t) {
      if (!shared.last || t > 0) return;
      for (Index i = 1; i < n; ++i) part[0] += part[i];
    });
  }
};
struct BarrierOfSome {
  struct Shared {
    int unused;
  };
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
#ifdef __CUDA_ARCH__
    if (threadIdx.x < 100) __syncthreads();
#endif
    block.threads([&](int t) { out[256 * b + t] = t; });
  }
};
struct ShuffleOfSome {
  struct Shared {
    int unused;
  };
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
    block.template tiles<8>([&](auto& tile, int k) {
      const auto mine = tile.lanes([&](int lane) { return static_cast<double>(lane); });
#ifdef __CUDA_ARCH__
      if ((threadIdx.x & 7) == 3) return;
#endif
      const double sum = tile.sum(mine);
      tile.once([&] { out[32 * b + k] = sum; });
    });
  }
};

}  // namespace bb::faulty

// A kernel of checks on both sides: g++ on the host against nvcc's PTX, run on the CPU, on random numbers and on degenerate
// ones.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

#include "core/exec/buffer.hpp"
#include "tests/device_check/slots.hpp"
#include "tests/ptx/ptx_executor.hpp"

namespace bb::device_check {

using exec::Buffer;
using exec::Executor;
using exec::HostExecutor;
using exec::Index;

inline constexpr Index n_items = 2000;

/// Of eight items: four random, three on a coarse grid (coincident points, parallel edges, repeated eigenvalues), one
/// of these moved by a little; whole runs of one size between 1e-6 and 1e3, some items zero or constant, some with
/// numbers so small that they have fewer digits (of double or of float) among the others.
template <class T>
std::vector<T> inputs() {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<T> out(static_cast<std::size_t>(n_items * Columns<T>::n_in));
  constexpr double sizes[] = {1, 1, 1, 1e-6, 1e-3, 1e3};
  for (Index i = 0; i < n_items; ++i) {
    const auto kind = i % 8;
    const double size = sizes[static_cast<std::size_t>(random() % 6)], constant = u(random);
    for (Index k = 0; k < Columns<T>::n_in; ++k) {
      double x = u(random);
      if (kind >= 4) x = static_cast<double>(static_cast<int>(random() % 4) - 1) + (kind == 7 ? 1e-9 * x : 0);
      if (i % 200 == 5) x = constant;
      if (i % 200 == 6) x = 0;
      if (i % 200 == 13) x = k % 4 == 0 ? constant : 0;  // multiples of the identity, among others
      if (i % 100 == 17 && random() % 2 == 0) x *= i % 200 == 17 ? 1e-310 : 1e-40;
      out[static_cast<std::size_t>(i * Columns<T>::n_in + k)] = static_cast<T>(size * x);
    }
  }
  return out;
}

inline constexpr double unused = -7.25e30;  // what no function returns

template <template <class> class Check, class T>
std::vector<T> results(Executor& executor) {
  Buffer<T> in(executor, "in"), out(executor, "out");
  in.upload(inputs<T>());
  out.upload(std::vector<T>(static_cast<std::size_t>(n_items * Columns<T>::n_out), static_cast<T>(unused)));
  executor.each(n_items, Check<T>{{in.data(), out.data()}});
  return out.download();
}

struct Agreement {
  std::size_t numbers = 0, finite = 0, same = 0;
  double worst = 0;  // relative to the largest finite number of the item
};

template <class T>
Agreement compare(const std::vector<T>& a, const std::vector<T>& b) {
  Agreement out;
  for (Index i = 0; i < n_items; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i * Columns<T>::n_out),
                      end = begin + Columns<T>::n_out;
    double largest = 0;
    for (std::size_t k = begin; k < end; ++k) {
      if (std::isfinite(a[k]) && a[k] != static_cast<T>(unused))
        largest = std::max(largest, std::abs(double{a[k]}));
    }
    for (std::size_t k = begin; k < end; ++k) {
      if (a[k] == static_cast<T>(unused) && b[k] == static_cast<T>(unused)) continue;
      ++out.numbers;
      out.finite += std::isfinite(a[k]);
      const bool same = memcmp(&a[k], &b[k], sizeof(T)) == 0 || (std::isnan(a[k]) && std::isnan(b[k]));
      out.same += same;
      if (same) continue;
      if (out.numbers - out.same <= 3) {
        std::printf("    item %td, number %zu: %.17g on the host, %.17g on the device\n", i, k - begin,
                    double{a[k]}, double{b[k]});
      }
      const double difference = std::abs(double{a[k]} - double{b[k]}) / std::max(largest, 1e-300);
      out.worst = std::isfinite(difference) ? std::max(out.worst, difference) : INFINITY;
    }
  }
  return out;
}

template <template <class> class Check, class T = double>
Agreement agreement(std::size_t numbers_of_an_item) {
  HostExecutor host(exec::Order::forward);
  ptx::PtxExecutor device(exec::Order::shuffled, 3);
  const std::vector<T> a = results<Check, T>(host), b = results<Check, T>(device);
  const Agreement out = compare(a, b);
  EXPECT_EQ(out.numbers, numbers_of_an_item * n_items);
  EXPECT_GT(out.finite, out.numbers / 2);
  std::printf("    %zu numbers, %zu the same bits, worst relative difference %.2g\n", out.numbers, out.same,
              out.worst);
  return out;
}
template <template <class> class Check, class T = double>
void expect_same_bits(std::size_t numbers_of_an_item) {
  const Agreement a = agreement<Check, T>(numbers_of_an_item);
  EXPECT_EQ(a.same, a.numbers) << a.worst;
}

}  // namespace bb::device_check

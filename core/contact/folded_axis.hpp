// Where coordinates are put along one axis before they become floats: near 0, and without the empty stretches between
// groups of bodies that are very far from each other. A float is fine near 0 alone, so that one body far away must
// not decide how finely all others are seen. Shared with kernels.
#pragma once

#include <cmath>

#include "core/math/host_device.hpp"

namespace bb {

/// Groups of bodies that one axis distinguishes.
constexpr int most_stretches = 8;
/// Points whose sorted coordinates say where a scene is; all of a smaller scene.
constexpr int most_sampled = 128;

/// By how much the places of a coordinate that moves from x0 to x1, of which `moved` is shared by all, can be off by
/// rounding, with a margin to spare, m; 0 where a number is NaN or infinite, as its box is then, too.
BB_HD inline double place_rounding(double x0, double x1, double moved) {
  const double room = 4 * 0x1p-52 * (std::abs(x0) + std::abs(x1) + std::abs(moved));
  return room - room == 0 ? room : 0;
}

/// A map x -> place, m, that never falls and never makes two places farther apart than what they come from, each to
/// rounding by an ulp of x: boxes that meet along the axis still do. Stretch k is moved by taken[k]; what lies in the
/// empty part behind it is put there too, no farther than where stretch k + 1 begins.
struct FoldedAxis {
  double begin[most_stretches] = {};  // where stretch k >= 1 begins, m
  double taken[most_stretches] = {};  // m
  int n = 1;

  BB_HD double operator()(double x) const {
    int k = 0;
    while (k + 1 < n && x >= begin[k + 1]) ++k;
    const double place = x - taken[k];
    if (k + 1 >= n) return place;
    const double next = begin[k + 1] - taken[k + 1];
    return place > next ? next : place;
  }
};

/// The frame in which floats are made: axes, and a grid of cubes that holds most of the scene's points.
struct FoldedFrame {
  FoldedAxis axis[3];
  double grid_lo[3] = {}, grid_width = 0;  // m, places
};

/// Number of sampled points of n, and the index of sample k: all, or some of all over the list.
constexpr int n_sampled(long long n) { return n < most_sampled ? static_cast<int>(n) : most_sampled; }
BB_HD constexpr long long sampled(int k, long long n) {
  if (n <= most_sampled) return k;
  const unsigned step = static_cast<unsigned>(k + 1) * 2654435769u;  // the golden ratio: evenly spread
  return static_cast<long long>(
      (static_cast<unsigned long long>(step) * static_cast<unsigned long long>(n)) >> 32);
}

/// The largest gaps of n sorted coordinates, largest first, the earlier of two equal ones first.
struct LargestGaps {
  static constexpr int most = most_stretches - 1;
  double size[most];  // m
  int after[most];    // the coordinate before the gap
  int n;
  double rest;  // all other gaps together, m
};

/// Loops of a fixed length: what they read and write stays in registers on a device.
template <class Sorted>
BB_HD LargestGaps largest_gaps(const Sorted& x, int n_coordinates) {
  constexpr int most = LargestGaps::most;
  const int wanted = n_coordinates / 16 < most ? n_coordinates / 16 : most;
  LargestGaps out{};
  for (int k = 0; k < most; ++k) out.size[k] = -1;  // less than any gap
  for (int i = 0; i + 1 < n_coordinates; ++i) {
    double gap = x(i + 1) - x(i);
    int behind = i;
    for (int k = 0; k < most; ++k) {
      if (k >= wanted || !(gap > out.size[k])) continue;
      const double smaller = out.size[k];
      const int its = out.after[k];
      out.size[k] = gap, out.after[k] = behind;
      gap = smaller, behind = its;
    }
    if (gap >= 0) out.rest += gap;
  }
  out.n = wanted;
  return out;
}

namespace detail {

/// Gaps that are more than 1000 `widths` become one.
template <class Sorted>
BB_HD FoldedAxis fold(const Sorted& x, int n, const LargestGaps& gaps, double width) {
  FoldedAxis out;
  if (n == 0) return out;
  int cut[most_stretches - 1], n_cuts = 0;
  for (int k = 0; k < gaps.n; ++k) {
    if (!(width > 0) || !(gaps.size[k] > 1000 * width)) continue;
    int place = n_cuts++;
    for (; place > 0 && cut[place - 1] > gaps.after[k]; --place) cut[place] = cut[place - 1];
    cut[place] = gaps.after[k];
  }
  int of_median = 0;
  for (int k = 0; k < n_cuts; ++k) {
    out.begin[k + 1] = x(cut[k] + 1);
    out.taken[k + 1] = out.taken[k] + (out.begin[k + 1] - x(cut[k]) - width);
    if (cut[k] < n / 2) of_median = k + 1;
  }
  out.n = n_cuts + 1;
  const double origin = x(n / 2) - out.taken[of_median];
  for (int k = 0; k < out.n; ++k) out.taken[k] += origin;
  return out;
}

}  // namespace detail

/// What is shared of a motion along an axis: the median of the displacements of the sampled points. displacement(i): of n
/// finite and sorted ones, m.
template <class Sorted>
BB_HD double median_of(const Sorted& displacement, int n) {
  return displacement(n / 2);
}

/// An axis, and where most of the points are along it, m, places.
struct AxisFrame {
  FoldedAxis axis;
  double middle = 0, spread = 0;
};
template <class Sorted>
BB_HD AxisFrame axis_frame(const Sorted& x, int n, const LargestGaps& gaps, double width) {
  AxisFrame out;
  out.axis = detail::fold(x, n, gaps, width);
  if (n == 0) return out;
  const double lo = out.axis(x(n / 8)), hi = out.axis(x(n - 1 - n / 8));
  out.middle = lo + (hi - lo) / 2;
  out.spread = hi - lo;
  return out;
}

/// What no gap that is taken for empty may be small against, m: the largest of `size` and of what the largest gaps of each
/// axis leave.
BB_HD inline double widest(const LargestGaps (&gaps)[3], double size) {
  double width = size;
  for (const LargestGaps& of : gaps) width = of.rest > width ? of.rest : width;
  return width;
}
BB_HD inline FoldedFrame joined(const AxisFrame (&axes)[3]) {
  FoldedFrame out;
  double spread = 0;
  for (int c = 0; c < 3; ++c) {
    out.axis[c] = axes[c].axis;
    spread = axes[c].spread > spread ? axes[c].spread : spread;
  }
  out.grid_width = 3 * spread;
  for (int c = 0; c < 3; ++c) out.grid_lo[c] = axes[c].middle - out.grid_width / 2;
  return out;
}

/// The frame of a scene. x(c, i): coordinate i of n_of(c) finite ones along axis c, sorted, m. size: what no gap that is
/// taken for empty may be small against, m; bodies that are folded together stay farther apart than that.
/// The median is put near 0.   Errors: none.   Cost: O(n).
template <class Coordinate, class Count>
BB_HD FoldedFrame folded_frame(const Coordinate& x, const Count& n_of, double size) {
  const auto sorted = [&](int c) { return [&x, c](int i) { return x(c, i); }; };
  LargestGaps gaps[3];
  for (int c = 0; c < 3; ++c) gaps[c] = largest_gaps(sorted(c), n_of(c));
  const double width = widest(gaps, size);
  AxisFrame axes[3];
  for (int c = 0; c < 3; ++c) axes[c] = axis_frame(sorted(c), n_of(c), gaps[c], width);
  return joined(axes);
}

}  // namespace bb

// Closest points and distances of pairs with their derivatives, and ACCD, over arrays of pairs.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>

#include "core/base/parameters/registry.hpp"
#include "core/geometry/accd.hpp"
#include "core/geometry/closest_points.hpp"
#include "core/geometry/distance_derivatives.hpp"
#include "core/math/error.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

/// [n pairs, points of a pair, 3] m
using Pairs = In<nb::shape<-1, -1, 3>>;

template <class F>
auto with_kind(const std::string& pair, F f) {
  using enum PairKind;
  if (pair == pair_name(point_point)) return f.template operator()<point_point>();
  if (pair == pair_name(point_edge)) return f.template operator()<point_edge>();
  if (pair == pair_name(point_triangle)) return f.template operator()<point_triangle>();
  if (pair == pair_name(edge_edge)) return f.template operator()<edge_edge>();
  throw unknown_name(
      "pair", pair,
      {pair_name(point_point), pair_name(point_edge), pair_name(point_triangle), pair_name(edge_edge)});
}

void require_points(const char* where, const Pairs& x, int points) {
  if (x.shape(1) != static_cast<std::size_t>(points)) {
    throw ConfigError(where, std::to_string(x.shape(1)) + " points",
                      std::to_string(points) + " points a pair");
  }
  const std::size_t size = x.shape(0) * x.shape(1) * 3;
  for (std::size_t i = 0; i < size; ++i) {
    if (!std::isfinite(x.data()[i])) {
      throw ConfigError(where, "pair " + std::to_string(i / (3 * x.shape(1))) + " is not finite",
                        "finite metres");
    }
  }
}

template <int N>
Mat<double, 3, N> points_of(const Pairs& x, std::size_t pair) {
  return Eigen::Map<const Mat<double, 3, N>>(x.data() + 3 * N * pair);
}

using Array = nb::ndarray<nb::numpy, double>;

/// d [n], weights [n, N], r [n, 3], region names [n], gradient [n, N, 3].
auto closest(const std::string& pair, const Pairs& x) {
  return with_kind(pair, [&x]<PairKind K>() {
    constexpr int N = pair_points(K);
    require_points("points", x, N);
    const std::size_t n = x.shape(0);
    std::vector<double> d(n), weights(n * N), r(3 * n), gradient(3 * N * n);
    std::vector<std::string> regions(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Closest<double, N> c = closest_points<K, double>(points_of<N>(x, i));
      d[i] = c.d;
      regions[i] = region_name(c.region);
      const Vec3d normal = c.d > 0 ? Vec3d(c.r / c.d) : Vec3d::Zero();
      for (int k = 0; k < 3; ++k) r[3 * i + static_cast<std::size_t>(k)] = c.r[k];
      for (int j = 0; j < N; ++j) {
        const std::size_t at = N * i + static_cast<std::size_t>(j);
        weights[at] = c.weights[j];
        for (int k = 0; k < 3; ++k) gradient[3 * at + static_cast<std::size_t>(k)] = c.weights[j] * normal[k];
      }
    }
    return std::make_tuple(array_of(std::move(d), n), array_of(std::move(weights), n, N),
                           array_of(std::move(r), n, 3), std::move(regions),
                           array_of(std::move(gradient), n, N, 3));
  });
}

/// [n, 3 N, 3 N]
Array hessian(const std::string& pair, const Pairs& x) {
  return with_kind(pair, [&x]<PairKind K>() {
    constexpr int N = pair_points(K), size = 3 * N;
    require_points("points", x, N);
    const std::size_t n = x.shape(0);
    std::vector<double> out(n * size * size);
    for (std::size_t i = 0; i < n; ++i) {
      const Mat<double, 3, N> points = points_of<N>(x, i);
      const Closest<double, N> c = closest_points<K, double>(points);
      if (!(c.d > 0)) {
        throw ConfigError("points", "pair " + std::to_string(i) + " touches",
                          "a distance above 0, where it has a Hessian");
      }
      Eigen::Map<Mat<double, size, size>>(out.data() + size * size * i) =
          distance_derivatives<double, N>(points, c).hessian;
    }
    return array_of(std::move(out), n, size, size);
  });
}

/// toi [n], hit [n], overlap_at_start [n], probes [n].
auto collide(const std::string& pair, const Pairs& x0, const Pairs& x1, double offset, double park) {
  if (!(offset >= 0)) throw ConfigError("offset", std::to_string(offset), "a thickness >= 0 m");
  if (!(park >= 0)) throw ConfigError("park", std::to_string(park), "a distance >= 0 m");
  return with_kind(pair, [&]<PairKind K>() {
    constexpr int N = pair_points(K);
    require_points("points_t0", x0, N);
    require_points("points_t1", x1, N);
    const std::size_t n = x0.shape(0);
    if (x1.shape(0) != n) {
      throw ConfigError("points_t1", std::to_string(x1.shape(0)) + " pairs",
                        "as many as at t = 0: " + std::to_string(n));
    }
    std::vector<double> toi(n);
    std::vector<std::uint8_t> hit(n), overlap(n);
    std::vector<std::int32_t> probes(n);
    for (std::size_t i = 0; i < n; ++i) {
      const AccdResult<double> found =
          accd<K, double>(points_of<N>(x0, i), points_of<N>(x1, i), offset, park);
      toi[i] = found.toi;
      hit[i] = found.hit;
      overlap[i] = found.overlap_at_start;
      probes[i] = found.probes;
    }
    return std::make_tuple(array_of(std::move(toi), n), array_of(std::move(hit), n),
                           array_of(std::move(overlap), n), array_of(std::move(probes), n));
  });
}

}  // namespace

void bind_geometry(nb::module_& m) {
  m.def("closest", &closest, nb::arg("pair"), nb::arg("points"),
        "d, weights, r, regions, gradient of n pairs.");
  m.def("distance_hessian", &hessian, nb::arg("pair"), nb::arg("points"));
  m.def("accd", &collide, nb::arg("pair"), nb::arg("points_t0"), nb::arg("points_t1"), nb::arg("offset"),
        nb::arg("park"), "toi, hit, overlap_at_start, probes of n pairs.");
}

}  // namespace bb::python

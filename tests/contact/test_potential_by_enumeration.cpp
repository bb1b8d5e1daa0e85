// B of two rough sheets by its definition: every point with every triangle and every edge with every edge, distances and mollifiers in
// long double, as they are, weighted by area, and so that every closest feature counts once. What the IPC Toolkit judges of sums, here
// by nothing but the definition.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/contact/barrier_gradient.hpp"
#include "tests/geometry/closest_oracle.hpp"

namespace bb::test::potential_by_enumeration_test {
namespace {

constexpr double reach = 0.12;

Long b_of(Long d) {
  return d < Long(reach) ? (Long(reach) - d) * (Long(reach) - d) * (Long(reach) - d) / Long(reach) : 0;
}

/// By enumeration of the scene's surface.
class Enumerated {
 public:
  Enumerated(const Scene& scene, const Positions& x) : scene_(scene), x_(x.cast<Long>()) {
    for (const auto& t : scene.surface_triangles) {
      const Vec3d a = scene.rest.col(t[0]), b = scene.rest.col(t[1]), c = scene.rest.col(t[2]);
      const double area = (b - a).cross(c - a).norm() / 2;
      for (std::size_t k = 0; k < 3; ++k) {
        of_point_[t[k]] += area / 3;
        of_edge_[std::minmax(t[k], t[(k + 1) % 3])] += area / 3;
      }
    }
    for (const auto& [edge, area] : of_edge_) edges_.push_back(edge);
  }

  double plain() const {
    Long sum = 0;
    for_each_point_triangle([&](int p, const auto& t) {
      sum += b_of(distance({p, t[0], t[1], t[2]}, 4, 1));
    });
    for_each_edge_pair([&](const auto& e, const auto& f) { sum += mollified(e, f); });
    return static_cast<double>(sum);
  }
  double weighted() const {
    Long sum = 0;
    for_each_point_triangle([&](int p, const auto& t) {
      sum += of_point_.at(p) / 4 * b_of(distance({p, t[0], t[1], t[2]}, 4, 1));
    });
    for_each_edge_pair([&](const auto& e, const auto& f) {
      sum += (of_edge_.at(e) + of_edge_.at(f)) / 4 * mollified(e, f);
    });
    return static_cast<double>(sum);
  }
  /// For a point inclusion and exclusion: triangles, less the edges between two of them, plus vertices that these leave out. For an
  /// edge: its edges, less, at every vertex, all but one of those that meet there.
  double corrected() const {
    Long sum = weighted();
    for (const auto& [p, area] : of_point_) {
      std::map<std::pair<int, int>, int> at_edge;
      std::map<int, int> at_vertex;
      for (const auto& t : scene_.surface_triangles) {
        if (t[0] == p || t[1] == p || t[2] == p) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          ++at_edge[std::minmax(t[k], t[(k + 1) % 3])];
          ++at_vertex[t[k]];
        }
      }
      std::map<int, int> between;  // two triangles at a vertex
      for (const auto& [edge, n] : at_edge) {
        sum -= area / 4 * (n - 1) * b_of(distance({p, edge.first, edge.second}, 3, 1));
        between[edge.first] += n - 1, between[edge.second] += n - 1;
      }
      for (const auto& [v, n] : at_vertex)
        sum += area / 4 * (1 - (n - between[v])) * b_of(distance({p, v}, 2, 1));
    }
    for (const auto& [e, area] : of_edge_) {
      std::map<int, Long> counted;
      for (const auto& f : edges_) {
        if (meet(e, f)) continue;
        for (const int v : {f.first, f.second}) counted[v] += mollifier(e, f);
      }
      for (const auto& [v, n] : counted) {
        std::size_t plain = 0, softened = 0;
        Long soft = 0;
        for (const auto& f : edges_) {
          if (meet(e, f) || (f.first != v && f.second != v)) continue;
          const Long m = mollifier(e, f);
          m < 1 ? (++softened, soft += m) : static_cast<Long>(++plain);
        }
        sum -=
            area / 4 * (static_cast<Long>(plain) - 1 + soft) * b_of(distance({v, e.first, e.second}, 3, 1));
        softened_ += softened;
      }
    }
    return static_cast<double>(sum);
  }
  std::size_t softened() const { return softened_; }
  std::size_t near() const { return near_; }

 private:
  using Edge = std::pair<int, int>;
  static bool meet(const Edge& e, const Edge& f) {
    return e.first == f.first || e.first == f.second || e.second == f.first || e.second == f.second;
  }
  Long distance(std::initializer_list<int> vertices, int n, int split) const {
    Points<Long, 4> p = Points<Long, 4>::Zero();
    int k = 0;
    for (const int v : vertices) p.col(k++) = x_.col(v);
    for (int c = 0; c < 3; ++c) {  // far apart along an axis
      const auto first = p.row(c).head(split), second = p.row(c).segment(split, n - split);
      if (first.minCoeff() - second.maxCoeff() > Long(reach) ||
          second.minCoeff() - first.maxCoeff() > Long(reach))
        return std::numeric_limits<Long>::infinity();
    }
    const Long out = enumerate_faces(p, n, split).d;
    near_ += out < Long(reach);
    return out;
  }
  Long mollifier(const Edge& e, const Edge& f) const {
    const auto squared = [](const auto& of, const Edge& edge) {
      return (of.col(edge.second) - of.col(edge.first)).squaredNorm();
    };
    const Long eps = Long(1e-3) * squared(scene_.rest.cast<Long>().eval(), e) *
                     squared(scene_.rest.cast<Long>().eval(), f);
    const Vec<Long, 3> a = x_.col(e.second) - x_.col(e.first), b = x_.col(f.second) - x_.col(f.first);
    const Long c = a.cross(b).squaredNorm() / eps;
    return c < 1 ? c * (2 - c) : Long(1);
  }
  Long mollified(const Edge& e, const Edge& f) const {
    const Long b = b_of(distance({e.first, e.second, f.first, f.second}, 4, 2));
    return b > 0 ? mollifier(e, f) * b : 0;
  }
  template <class F>
  void for_each_point_triangle(const F& f) const {
    for (const int p : scene_.surface_vertices) {
      for (const auto& t : scene_.surface_triangles)
        if (t[0] != p && t[1] != p && t[2] != p) f(p, t);
    }
  }
  template <class F>
  void for_each_edge_pair(const F& f) const {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      for (std::size_t j = i + 1; j < edges_.size(); ++j)
        if (!meet(edges_[i], edges_[j])) f(edges_[i], edges_[j]);
    }
  }

  const Scene& scene_;
  Eigen::Matrix<Long, 3, Eigen::Dynamic> x_;
  std::map<int, double> of_point_;
  std::map<Edge, double> of_edge_;
  std::vector<Edge> edges_;
  mutable std::size_t softened_ = 0, near_ = 0;
};

/// Two sheets of 3 x 3 cells of side 0.25, the upper one turned a little and rough: pairs of either sheet with itself are out of reach.
Scene two_sheets(unsigned seed, bool aligned) {
  Scene scene;
  const auto [lower, triangles] = grid(3, 3, 0.25);
  auto [upper, same] = grid(3, 3, 0.25, Vec3d(aligned ? 0.03 : 0.08, 0.05, 0.07));
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (Vec3d& x : upper) {
    if (!aligned) x = Eigen::AngleAxisd(0.2, Vec3d::UnitZ()) * x;
    x += Vec3d(0.002, 0.002, 0.02).cwiseProduct(Vec3d(unit(rng), unit(rng), unit(rng)));
  }
  add_body(scene, "lower", lower, triangles, reach);
  add_body(scene, "upper", upper, same, reach);
  return scene;
}

struct Found {
  double energy = 0;
  VecXd gradient;
  std::size_t rows = 0, mollified = 0;
};

Found found(const Scene& scene, const Positions& x, ContactWeighting weighting) {
  ContactOptions options;
  options.weighting = weighting;
  ContactSystem contacts(scene, options);
  Rows rows = rows_at(contacts, x);
  evaluate(rows.table, 1, TestShape::cubic);
  evaluate(rows.mollified, 1, TestShape::cubic);
  if (weighting != ContactWeighting::none)
    rows.table.kappa = rows.table.share, rows.mollified.kappa = rows.mollified.share;
  return {energy_of(rows, x), gradient_of(rows, x), rows.table.size(), rows.mollified.size()};
}

constexpr ContactWeighting weightings[] = {ContactWeighting::none, ContactWeighting::area,
                                           ContactWeighting::area_corrected};

double enumerated(const Enumerated& of, ContactWeighting weighting) {
  if (weighting == ContactWeighting::none) return of.plain();
  return weighting == ContactWeighting::area ? of.weighted() : of.corrected();
}

TEST(PotentialByEnumeration, IsTheSumOverAllPairs) {
  std::size_t rows = 0, mollified = 0, softened = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    for (const bool aligned : {false, true}) {
      const Scene scene = two_sheets(seed, aligned);
      for (const ContactWeighting weighting : weightings) {
        const Found mine = found(scene, scene.x0, weighting);
        const Enumerated of(scene, scene.x0);
        const double expected = enumerated(of, weighting);
        ASSERT_GT(expected, 0);
        EXPECT_NEAR(mine.energy, expected, 1e-12 * expected)
            << seed << (aligned ? " aligned, " : " turned, ") << static_cast<int>(weighting);
        EXPECT_GT(of.near(), 20U);
        rows += mine.rows, mollified += mine.mollified, softened += of.softened();
      }
    }
  }
  EXPECT_GT(rows, 1000U);
  EXPECT_GT(mollified, 50U);
  EXPECT_GT(softened, 50U) << "no correction is of a mollified pair";
}

TEST(PotentialByEnumeration, HasItsGradient) {
  constexpr double h = 1e-5;
  for (const bool aligned : {false, true}) {
    const Scene scene = two_sheets(11, aligned);
    for (const ContactWeighting weighting : weightings) {
      const Found mine = found(scene, scene.x0, weighting);
      const double size = mine.gradient.cwiseAbs().maxCoeff();
      ASSERT_GT(size, 0);
      for (Eigen::Index i = 0; i < scene.x0.size(); i += 5) {
        Positions ends[2] = {scene.x0, scene.x0};
        ends[0].data()[i] -= h, ends[1].data()[i] += h;
        const double slope = (enumerated(Enumerated(scene, ends[1]), weighting) -
                              enumerated(Enumerated(scene, ends[0]), weighting)) /
                             (2 * h);
        EXPECT_NEAR(mine.gradient[i], slope, 1e-5 * size) << i << " " << static_cast<int>(weighting);
      }
    }
  }
}

}  // namespace
}  // namespace bb::test::potential_by_enumeration_test

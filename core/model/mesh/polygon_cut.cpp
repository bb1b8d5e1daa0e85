#include "core/model/mesh/polygon_cut.hpp"

#include <algorithm>
#include <limits>

#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Zero area up to the rounding of the cross product: below 4 eps of the squared longest edge, relative to
/// which coordinates are subtracted exactly or with one rounding.
bool is_flat(const Positions& x, const std::array<int, 3>& t, const Vec3d& area) {
  double longest_sq = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest_sq = std::max(longest_sq, (x.col(t[k]) - x.col(t[(k + 1) % 3])).squaredNorm());
  }
  return !(area.norm() > 4 * std::numeric_limits<double>::epsilon() * longest_sq);
}

Vec3d whole_area(const Positions& x, const std::vector<int>& polygon) {
  Vec3d whole = Vec3d::Zero();
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    whole += area_vector(x, {polygon[0], polygon[k - 1], polygon[k]});
  }
  return whole;
}

Triangles fan_from(const std::vector<int>& polygon, std::size_t start) {
  const std::size_t n = polygon.size();
  const auto corner = [&](std::size_t k) { return polygon[(start + k) % n]; };
  Triangles fan;
  for (std::size_t k = 2; k < n; ++k) fan.push_back({corner(0), corner(k - 1), corner(k)});
  return fan;
}

/// Ears of a polygon in the coordinate plane that it faces most.
class Ears {
 public:
  Ears(const Positions& x, std::vector<int> polygon) : x_(x), left_(std::move(polygon)) {
    const Vec3d whole = whole_area(x, left_);
    Eigen::Index most = 0;
    whole.cwiseAbs().maxCoeff(&most);
    u_ = (most + 1) % 3, v_ = (most + 2) % 3;
    sign_ = whole[most] < 0 ? -1 : 1;
  }

  std::optional<Triangles> run() {
    Triangles cut;
    while (left_.size() > 3) {
      const std::optional<std::size_t> ear = next();
      if (!ear) return std::nullopt;
      cut.push_back(at(*ear));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(*ear));
    }
    cut.push_back({left_[0], left_[1], left_[2]});
    // signed areas add up to that of the whole: what sides that cross count twice is missing in the last one
    return turn(left_[0], left_[1], left_[2]) < 0 ? std::nullopt : std::optional(cut);
  }

 private:
  std::array<int, 3> at(std::size_t k) const {
    const std::size_t n = left_.size();
    return {left_[(k + n - 1) % n], left_[k], left_[(k + 1) % n]};
  }
  /// Twice the area, > 0 for a turn in the sense of the whole.
  double turn(int a, int b, int c) const {
    return sign_ * ((x_(u_, b) - x_(u_, a)) * (x_(v_, c) - x_(v_, a)) -
                    (x_(v_, b) - x_(v_, a)) * (x_(u_, c) - x_(u_, a)));
  }
  bool holds_another(const std::array<int, 3>& t) const {
    return std::any_of(left_.begin(), left_.end(), [&](int p) {
      return p != t[0] && p != t[1] && p != t[2] && turn(t[0], t[1], p) >= 0 && turn(t[1], t[2], p) >= 0 &&
             turn(t[2], t[0], p) >= 0;
    });
  }
  /// A corner that can be cut off: the first with an area, otherwise a flat one.
  std::optional<std::size_t> next() const {
    std::optional<std::size_t> flat;
    for (std::size_t k = 0; k < left_.size(); ++k) {
      const std::array<int, 3> t = at(k);
      const double area = turn(t[0], t[1], t[2]);
      if (area > 0 && !holds_another(t)) return k;
      if (area == 0 && !flat) flat = k;
    }
    return flat;
  }

  const Positions& x_;
  std::vector<int> left_;
  Eigen::Index u_ = 0, v_ = 1;
  double sign_ = 1;
};

}  // namespace

std::optional<Triangles> fan_of(const Positions& x, const std::vector<int>& polygon) {
  const Vec3d whole = whole_area(x, polygon);
  const std::size_t starts = polygon.size() <= most_concave_corners ? polygon.size() : 1;
  for (std::size_t start = 0; start < starts; ++start) {
    Triangles fan = fan_from(polygon, start);
    const bool covers = std::all_of(fan.begin(), fan.end(), [&](const std::array<int, 3>& t) {
      const Vec3d area = area_vector(x, t);
      return !is_flat(x, t, area) && (polygon.size() == 3 || area.dot(whole) > 0);
    });
    if (covers) return fan;
    if (polygon.size() == 3) break;
  }
  return std::nullopt;
}

std::optional<Triangles> cut_of(const Positions& x, const std::vector<int>& polygon) {
  if (polygon.size() == 3) return Triangles{{polygon[0], polygon[1], polygon[2]}};
  if (!whole_area(x, polygon).allFinite()) return std::nullopt;
  if (auto fan = fan_of(x, polygon)) return fan;
  if (polygon.size() > most_concave_corners) return std::nullopt;
  return Ears(x, polygon).run();
}

bool has_flat_corner(const Positions& x, const std::vector<int>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::array<int, 3> t{polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]};
    if (is_flat(x, t, area_vector(x, t))) return true;
  }
  return false;
}

}  // namespace bb

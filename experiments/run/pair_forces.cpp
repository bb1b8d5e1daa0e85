#include "experiments/run/pair_forces.hpp"

#include <fmt/format.h>

#include <map>

#include "core/base/archive/archive.hpp"
#include "experiments/run/csv_cell.hpp"

namespace bb {
namespace {

constexpr const char* heading =
    "step,t_s,body_a,body_b,contacts,normal_N,friction_N,contact_x_N,contact_y_N,contact_z_N,friction_x_N,"
    "friction_y_N,friction_z_N,contact_work_J,friction_work_J,area_m2\n";

void keep_vector(Archive& archive, Vec3d& v) {
  for (double& number : v) archive(number);
}

/// What a row does to a body.
Vec3d force_on(const Scene& scene, const ContactForce& row, int body) {
  Vec3d out = Vec3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    const int v = row.vertex[k];
    if (v >= 0 && scene.body[static_cast<std::size_t>(v)] == body) out += row.force[k];
  }
  return out;
}

void add_row(const Scene& scene, const ContactForce& row, PairForce& sum) {
  const Vec3d force = force_on(scene, row, sum.pair.first);
  const bool rubs = row.term == "friction";
  sum.contacts += row.term == "contact";
  (rubs ? sum.friction : sum.contact) += force;
  (rubs ? sum.friction_work_J : sum.contact_work_J) += row.work;
  if (rubs) {
    sum.friction_N += row.tangential;
  } else {
    sum.normal_N += row.normal;
  }
  if (row.area) sum.area_m2 = sum.area_m2.value_or(0) + *row.area;
}

}  // namespace

void PairForce::keep(Archive& archive) {
  archive(step, t_s, pair.first, pair.second, contacts, normal_N, friction_N);
  keep_vector(archive, contact), keep_vector(archive, friction);
  archive(contact_work_J, friction_work_J, area_m2);
}

void PairForces::add(int step, double t_s, const std::vector<ContactForce>& rows) {
  std::map<BodyPair, PairForce> sums;
  for (const ContactForce& row : rows) {
    const BodyPair pair = body_pair(scene_, row.key);
    PairForce& sum = sums[pair];
    sum.pair = pair;
    add_row(scene_, row, sum);
  }
  for (auto& [pair, sum] : sums) {
    sum.step = step;
    sum.t_s = t_s;
    rows_.push_back(sum);
  }
}

std::string PairForces::csv() const {
  std::string out = heading;
  for (const PairForce& row : rows_) {
    const Vec3d &c = row.contact, &f = row.friction;
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.step, row.t_s,
                       csv_cell(owner_name(scene_, row.pair.first)),
                       csv_cell(owner_name(scene_, row.pair.second)), row.contacts, row.normal_N,
                       row.friction_N, c[0], c[1], c[2], f[0], f[1], f[2], row.contact_work_J,
                       row.friction_work_J, row.area_m2 ? fmt::format("{}", *row.area_m2) : "");
  }
  return out;
}

void PairForces::keep(Archive& archive) { archive.grown("pair forces", rows_); }

}  // namespace bb

#include "experiments/run/device_memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/executor/policy_kernels.hpp"
#include "core/contact/surface.hpp"
#include "core/exec/counting_executor.hpp"
#include "core/newton/executor/executor_engine.hpp"
#include "core/newton/newton_system.hpp"
#include "experiments/run/contact_count.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

double mean_edge(const Surface& surface, const Scene& scene) {
  double sum = 0;
  for (const auto& edge : surface.edges.vertices)
    sum += (scene.x0.col(edge[0]) - scene.x0.col(edge[1])).norm();
  return sum / static_cast<double>(surface.edges.size());
}

double bytes_a_row(const Method& method) {
  exec::CountingExecutor executor;
  constexpr exec::Index n = 1 << 20;
  exec::ExecutorRows rows(executor, exec::columns_of(*method.stiffness));
  rows.resize(n);
  return static_cast<double>(executor.memory().bytes()) / n;
}

exec::ExpectedContacts expected_contacts(const ContactDemand& demand, double contacts,
                                         const ContactPlan& plan) {
  exec::ExpectedContacts out;
  out.rows = std::llround(contacts);
  if (plan.mollifier.needed) out.mollified = out.rows / 100;
  out.upper_blocks_a_row = demand.upper_blocks_a_contact;
  const exec::Index n = std::llround(contacts * demand.candidates_a_contact);
  exec::CandidateCounts& of = out.candidates;
  if (plan.edge_edge && plan.point_triangle) {
    of.point_triangle = n / 3;
    of.edge_edge = n - n / 3;
  } else {
    (plan.point_edge ? of.point_edge : plan.point_point ? of.point_point : of.obstacle) = n;
  }
  return out;
}

/// What contact there is at the start where that is at least one a vertex, else an estimate of what there may be; and in words.
std::pair<double, std::string> expected_number(const RunConfig& config, const Scene& scene,
                                               const Plan& plan) {
  const StartContacts start = contacts_at_start(scene, plan.contacts, contact_options(config.contact));
  if (start.a_vertex >= 1) {
    return {std::ceil(start.total), fmt::format("at the start: {:.4g} a vertex, counted at {} vertices",
                                                start.a_vertex, start.sampled)};
  }
  return {std::ceil(estimated_contacts(scene)),
          "estimated: every sheet lies on one other at half its activation distance"};
}

}  // namespace

double estimated_contacts(const Scene& scene) {
  const Surface surface(scene);
  const auto points = static_cast<double>(surface.points.size());
  if (surface.edges.size() == 0) return points * static_cast<double>(scene.obstacles.size());
  const double h = mean_edge(surface, scene), reach = std::sqrt(0.75) * scene.d_hat.front();
  if (surface.triangles.size() == 0) return points * (1 + 2 * reach / h);
  // per vertex, of a regular mesh: 2 triangles and 3 edges on an area of sqrt(3)/2 h^2. A primitive is in reach where
  // the other one, made wider by the reach, covers it.
  const double area = std::sqrt(0.75) * h * h, disc = std::numbers::pi * reach * reach;
  const double triangles = 2 / area * (area / 2 + 3 * h * reach + disc);
  const double edges = 3 * 3 / area * (2 / std::numbers::pi * h * h + 4 * h * reach + disc);
  return points * (2 * triangles + edges);
}

DeviceMemory count_device_memory(const RunConfig& config, const Scene& scene, const Plan& plan,
                                 const ContactDemand& demand) {
  Calibration any;  // numbers of the stiffness need no memory
  any.kappa = any.k_s = any.solid_k_s = 1;
  Method method = make_method(config, any);
  DeviceMemory out;
  out.source = "the scene has no contact";
  if (plan.term("contact").needed) {
    out.contacts = demand.contacts;
    out.source = "--contacts";
    if (demand.contacts == 0) std::tie(out.contacts, out.source) = expected_number(config, scene, plan);
    out.bytes_a_row = bytes_a_row(method);
  }
  method.make_potential = [](const Scene& of, Method& with, const Plan& parts,
                             const std::vector<std::uint8_t>& fixed, PhaseClock& clock) {
    return std::make_unique<exec::ExecutorEngine>(std::make_unique<exec::CountingExecutor>(true), of, with,
                                                  parts, fixed, clock);
  };
  NewtonSystem system(scene, method, plan);
  auto& potential = dynamic_cast<exec::ExecutorEngine&>(system.potential());
  exec::count_memory(system, potential, scene, expected_contacts(demand, out.contacts, plan.contacts));
  const exec::MemoryLedger& memory = potential.memory();
  out.total = memory.peak();
  out.buffers.assign(memory.at_peak().begin(), memory.at_peak().end());
  std::ranges::stable_sort(out.buffers, std::greater<>{}, &std::pair<std::string, std::size_t>::second);
  return out;
}

}  // namespace bb

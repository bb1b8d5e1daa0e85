// Columns of every family on an executor, which its matrix is summed from, against the local terms that the host's is summed from, number by
// number: energies, gradients, Hessians of every request, in every order and in pieces.
#include <gtest/gtest.h>

#include "core/energy/families/families.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/model/bodies/part.hpp"
#include "tests/executor/on_executor.hpp"

namespace bb::exec_family_columns_test {
namespace {

using namespace bb::test;

/// All but the loads of every vertex, which an executor adds in launches of their own, in the step of step_frame().
std::vector<MadeFamily> families_of(exec::Executor& executor, const Scene& scene, const FamilyStep& step) {
  std::vector<MadeFamily> out;
  for (const PartEntry& entry : part_entries()) {
    if (entry.part.size(scene) > 0) entry.part.add_families(scene, {executor}, out);
  }
  if (!scene.pulls.empty()) out.push_back(pull_family({executor}, scene));
  if (!scene.air.wind_keys.empty()) out.push_back(air_drag_family({executor}, scene));
  if (!scene.inflation.triangles.empty()) out.push_back(inflation_family({executor}, scene));
  if (!scene.stitches.pairs.empty()) out.push_back(stitch_family({executor}, scene.stitches));
  for (const MadeFamily& family : out) family->begin_step(step);
  return out;
}

/// Of the host's local terms of one element.
class Expected {
 public:
  Expected(ElementFamily& family, const std::vector<double>& x) : family_(family) {
    for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute})
      family.derivatives(x.data(), projection, of_[static_cast<std::size_t>(projection)]);
  }
  const LocalTerms& of(Projection projection) const { return of_[static_cast<std::size_t>(projection)]; }
  double hessian(const HessianRequest& request, const std::vector<double>& force, std::size_t e,
                 std::size_t k) const {
    const auto w = static_cast<std::size_t>(family_.width());
    bool clamp = false;
    for (std::size_t i = w * e; i < w * (e + 1); ++i) {
      clamp = clamp || (request.threshold >= 0 &&
                        force[static_cast<std::size_t>(family_.vertices()[i])] >= request.threshold);
    }
    const std::size_t at = n_lower_numbers(w) * e + k;
    const double psd = of(Projection::psd).hess[at], first = clamp ? psd : of(request.first).hess[at];
    return request.t > 0 ? first + request.t * (psd - first) : first;
  }

 private:
  ElementFamily& family_;
  LocalTerms of_[3];
};

void expect_columns(exec::Executor& executor, ElementFamily& family, const Expected& expected,
                    const exec::Buffer<double>& x, const std::vector<double>& force) {
  const exec::Index n = family.size();
  const auto w = static_cast<std::size_t>(family.width());
  exec::Buffer<double> energy(executor, "energy", n), value(executor, "value", n), forces(executor, "force");
  forces.upload(force);
  family.values(x.data(), value.data());
  EXPECT_EQ(value.download(), expected.of(Projection::none).energy);
  const HessianRequest requests[] = {{Projection::none},
                                     {Projection::psd},
                                     {Projection::absolute},
                                     {Projection::none, 0.25},
                                     {Projection::none, 0, 0.5, forces.data()}};
  for (exec::Index begin = 0, size = 3; begin < n; begin += size, size = 3 * size + 1) {
    const Piece piece{begin, std::min(size, n - begin)};
    const auto m = static_cast<std::size_t>(piece.n);
    exec::Buffer<double> column(executor, "column", piece.n * static_cast<exec::Index>(n_lower_numbers(w)));
    family.gradients(piece, x.data(), energy.data(), column.data());
    std::vector<double> found = column.download();
    for (std::size_t i = 0; i < 3 * w * m; ++i) {
      const std::size_t e = static_cast<std::size_t>(begin) + i % m;
      EXPECT_EQ(found[i], expected.of(Projection::none).grad[3 * w * e + i / m]);
    }
    if (!family.has_hessian()) continue;
    for (const HessianRequest& request : requests) {
      family.hessians(piece, request, x.data(), column.data());
      found = column.download();
      for (std::size_t i = 0; i < n_lower_numbers(w) * m; ++i) {
        const std::size_t e = static_cast<std::size_t>(begin) + i % m;
        ASSERT_EQ(found[i], expected.hessian(request, force, e, i / m)) << e << " " << i / m;
      }
    }
  }
  EXPECT_EQ(energy.download(), expected.of(Projection::none).energy);
}

TEST(ExecutorFamilies, HaveTheColumnsOfTheLocalTermsOfTheHost) {
  std::vector<TermCase> cases = element_cases();
  for (TermCase& one : driven_cases()) cases.push_back(std::move(one));
  int n_families = 0, n_indefinite = 0;
  for (const TermCase& one : cases) {
    SCOPED_TRACE(one.name);
    const Positions x = strained(one.scene, one.size);
    const StepFrame frame = step_frame(one.scene, one.c);
    std::vector<double> force(one.scene.mass.size(), 0);  // N: some vertices have a large one
    for (std::size_t v = 0; v < force.size(); v += 5) force[v] = 1;
    exec::HostExecutor host;
    const std::vector<MadeFamily> of_host = families_of(host, one.scene, StepColumns(frame).of_families());
    std::vector<Expected> expected;
    for (const MadeFamily& family : of_host) {
      expected.emplace_back(*family, std::vector<double>(x.data(), x.data() + x.size()));
      const Expected& last = expected.back();
      EXPECT_GT(
          *std::max_element(last.of(Projection::none).grad.begin(), last.of(Projection::none).grad.end()),
          1e-6);
      n_indefinite += last.of(Projection::none).hess != last.of(Projection::psd).hess;
    }
    for (const auto& executor : all_orders()) {
      exec::Buffer<double> state(*executor, "state"), x_n(*executor, "start"),
          x_tilde(*executor, "prediction");
      state.upload(numbers_of(x)), x_n.upload(numbers_of(frame.x_n)),
          x_tilde.upload(numbers_of(frame.x_tilde));
      FamilyStep step = StepColumns(frame).of_families();
      step.x_n = x_n.data(), step.x_tilde = x_tilde.data();
      const std::vector<MadeFamily> families = families_of(*executor, one.scene, step);
      ASSERT_EQ(families.size(), expected.size());
      for (std::size_t i = 0; i < families.size(); ++i)
        expect_columns(*executor, *families[i], expected[i], state, force);
    }
    n_families += static_cast<int>(expected.size());
  }
  EXPECT_GE(n_families, 40);
  EXPECT_GT(n_indefinite, 20);
}

}  // namespace
}  // namespace bb::exec_family_columns_test

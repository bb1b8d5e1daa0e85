// The verb explain: what a run would do and what it would skip, and why; of a run on a device its memory; then every
// setting with its default filled in.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/input/read_file.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/memory_ledger.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/collision_lines.hpp"
#include "experiments/run/device_memory.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/guarantee.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/runner.hpp"

namespace bb::cli {
namespace {

/// The policy with what the config gives of its parameters.
std::string stiffness_text(const PolicyConfig& policy) {
  std::string out = policy.name;
  for (const auto& [name, value] : policy.parameters) out += fmt::format(", {} {}", name, to_text(value));
  if (policy.scale != 1) out += fmt::format(", times {:g}", policy.scale);
  return out;
}

void print_method(const RunConfig& config) {
  if (config.method.empty()) return;
  const MethodUse use = method_use(config);
  show("method    {}: {}\n", use.title(), use.method.source);
  for (const std::string& pointer : use.overridden) show("  overridden: {}\n", pointer);
  for (const auto& [subject, text] : use.method.differs)
    print_wrapped(fmt::format("  differs, {}: {}", subject, text), 10);
}

/// Pointers of the method that stand as the method has them.
std::set<std::string> of_method(const RunConfig& config) {
  std::set<std::string> out;
  if (config.method.empty()) return out;
  const MethodUse use = method_use(config);
  for (const auto& [pointer, value] : leaves_of(use.method)) out.insert(pointer);
  for (const std::string& pointer : use.overridden) out.erase(pointer);
  return out;
}

void print_formulation(const RunConfig& config, const Scene& scene) {
  const FormulationConfig& contact = config.formulation;
  const StrainLimitConfig& limit = config.strain_limit;
  show("contact   {} on {}, d_hat {:g} m, {}\n", contact.shape, to_string(contact.argument), contact.d_hat,
       stiffness_text(contact.stiffness_policy));
  if (limit.enabled) {
    show("limit     {} on {}, onset {:g}, width {:g}, {}{}\n", limit.shape, to_string(limit.argument),
         limit.onset, limit.width, stiffness_text(limit.stiffness_policy),
         limit.solids.value_or(false) ? ", of triangles and tetrahedra" : "");
  }
  const char* head = "guarantee";
  for (const Guarantee& each :
       guarantees(step_solvers().require(config.step_solver.name, "/step_solver/name"), scene,
                  config.contact.model.value_or(ContactModel::all_pairs))) {
    show("{:<9} {}: {}\n", head, each.of, each.text);
    head = "";
  }
  if (scene.planar)
    show(
        "          in the plane contact is of boundaries: a triangle that turns inside out is kept from "
        "nothing\n");
  show("matching  {}{}\n\n", to_string(config.matching.rule),
       config.matching.rule == MatchingRule::as_given
           ? ""
           : fmt::format(", theta {:g}: a given stiffness is replaced", config.matching.theta));
}

/// One line a number, word or list of the resolved config: pointer, value, and where the value is from.
void print_settings(const RunVerb& verb, const RunConfig& config) {
  std::vector<Violation> ignored;  // load_config has judged the same text
  const std::string folder = std::filesystem::path(verb.config).parent_path().string();
  const nlohmann::json given =
      make_document(read_input_file(verb.config, config_file), verb.config, folder, verb.set, ignored);
  const nlohmann::json flat = settings_document(config).flatten();
  const std::set<std::string> by_method = of_method(config);
  show(
      "\nevery setting of the run (* given by the config or --set, m as its method has it; the others are "
      "defaults)\n");
  for (const auto& [pointer, value] : flat.items()) {
    const bool own = given.contains(nlohmann::json::json_pointer(pointer));
    const char from = by_method.contains(pointer) ? 'm' : own ? '*' : ' ';
    print_wrapped(fmt::format("  {} {:<52} {}", from, pointer, value.dump()), 8);
  }
}

/// Whether the card of this machine has enough memory, or that there is none to query.
void print_card(std::size_t total) {
  const cuda::DeviceProbe probe = cuda::probe_device();
  if (!probe.usable) {
    show("  no card was found: {}; local memory of kernels comes on top (docs/device.md, Memory)\n",
         probe.why);
    return;
  }
  const std::size_t local = cuda::local_memory_of_kernels();
  show("  {:<40} {:>12}\n", "local memory of kernels, at most", exec::bytes_text(local));
  total += local;
  show("  {}: {} free of {}: {}\n", probe.card, exec::bytes_text(probe.free), exec::bytes_text(probe.memory),
       total <= probe.free ? "it fits"
                           : "it does not fit, " + exec::bytes_text(total - probe.free) + " are missing");
}

void print_memory(const DeviceMemory& memory, const ContactDemand& demand) {
  show("\nmemory of the device at the peak of a step, buffer by buffer\n");
  show("  {:.6g} contacts ({}), each with {:.4g} candidates and {:.4g} stored blocks\n", memory.contacts,
       memory.source, demand.candidates_a_contact, demand.upper_blocks_a_contact);
  std::size_t rest = 0;
  for (const auto& [name, bytes] : memory.buffers) {
    if (200 * bytes < memory.total) {
      rest += bytes;
      continue;
    }
    show("  {:<40} {:>12}", name, exec::bytes_text(bytes));
    show("{}\n", memory.contacts > 0
                     ? fmt::format(" {:>8.2f} B a contact", static_cast<double>(bytes) / memory.contacts)
                     : "");
  }
  show("  {:<40} {:>12}\n", "all others, below 0.5 % each", exec::bytes_text(rest));
  show("  {:<40} {:>12}", "total", exec::bytes_text(memory.total));
  show("{}\n", memory.contacts > 0 ? fmt::format(" {:>8.2f} B a contact, {:g} B a contact row",
                                                 memory.bytes_a_contact(), memory.bytes_a_row)
                                   : "");
  print_card(memory.total);
}

/// "450 triangles, 640 hinges, " of the parts that the scene has.
std::string elements_text(const Scene& scene) {
  std::string out;
  for (const PartEntry& entry : part_entries()) {
    const std::size_t n = entry.part.size(scene);
    if (n > 0) out += fmt::format("{} {}, ", n, entry.part.elements());
  }
  return out;
}

void print_collisions(const Scene& scene) {
  constexpr std::size_t most = 200;
  const std::vector<CollisionLine> lines = collision_lines(scene);
  if (lines.empty()) return;
  show("\npairs of bodies\n");
  for (std::size_t i = 0; i < std::min(most, lines.size()); ++i) {
    show("  {:<40} {:<10} {}\n", lines[i].pair, word_of(lines[i].kind), lines[i].reason);
  }
  if (lines.size() > most) show("  and {} more\n", lines.size() - most);
}

int explain(const RunVerb& verb, const ContactDemand& demand) {
  const RunConfig config = load_run(verb.config, verb.set);
  const Scene scene = build_scene(config);
  const Plan plan = plan_of(config, scene);
  show("{}\n  {} vertices ({} prescribed), {}{} steps of {} s\n", run_label(config), scene.n_vertices(),
       scene.pins.size(), elements_text(scene), config.time.steps, config.time.dt);
  show("  surface: {} triangles, {} edges\n\n", scene.surface_triangles.size(), scene.surface_edges.size());
  print_method(config);
  print_formulation(config, scene);
  for (const bool needed : {true, false}) {
    show("{}\n", needed ? "runs" : "skipped");
    for (const auto& [name, item] : plan.items()) {
      if (item->needed == needed) print_wrapped(fmt::format("  {:<18} {}", name, item->reason), 21);
    }
  }
  print_collisions(scene);
  if (config.device != Device::cpu) print_memory(count_device_memory(config, scene, plan, demand), demand);
  print_settings(verb, config);
  return exit_ok;
}

void demand_arguments(CLI::App& app, ContactDemand& demand) {
  app.add_option("--contacts", demand.contacts,
                 "with a device: so many contacts are expected (default: those of the start where they are "
                 "at least one a vertex, else estimated from the scene)")
      ->check(finite_number(0, 1e12));
  app.add_option("--blocks-per-contact", demand.upper_blocks_a_contact,
                 "stored 3x3 blocks on and above the diagonal that a contact has (default 1.738, of "
                 "configs/gpu/dense_patch.json)")
      ->check(finite_number(0, 10));
  app.add_option(
         "--candidates-per-contact", demand.candidates_a_contact,
         "pairs of the broad phase that a contact has (default 6.145, of configs/gpu/dense_patch.json)")
      ->check(finite_number(0, 1e3));
}

}  // namespace

Action verb::explain(CLI::App& app) {
  const auto verb = std::make_shared<RunVerb>();
  const auto demand = std::make_shared<ContactDemand>();
  config_arguments(app, *verb);
  demand_arguments(app, *demand);
  return [verb, demand](const CommonOptions&) { return cli::explain(*verb, *demand); };
}

}  // namespace bb::cli

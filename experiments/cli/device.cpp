// The verb device: is there a card that this build can use, and how fast its memory is.
#include "core/exec/cuda/device.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "core/exec/cuda/copy_rates.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"

namespace bb::cli {
namespace {

using cuda::DeviceProbe;

struct DeviceVerb {
  bool json = false;
  bool measure = false;  // rates of copies too
};

std::string version_or_none(int version) { return version == 0 ? "none" : cuda::version_text(version); }

nlohmann::json as_json(const DeviceProbe& probe, const std::optional<cuda::CopyRates>& rates) {
  nlohmann::json out{{"schema", "barrierbench.device/1"},
                     {"built", probe.built},
                     {"usable", probe.usable},
                     {"why", probe.why},
                     {"card", probe.card},
                     {"capability", probe.capability},
                     {"driver", version_or_none(probe.driver)},
                     {"runtime", version_or_none(probe.runtime)},
                     {"memory_bytes", probe.memory},
                     {"free_bytes", probe.free},
                     {"copy", nullptr}};
  if (rates) {
    out["copy"] = {{"bytes", rates->bytes},
                   {"on_the_card_Bps", rates->copy},
                   {"to_the_card_Bps", rates->upload},
                   {"from_the_card_Bps", rates->download}};
  }
  return out;
}

void print(const DeviceProbe& probe, const std::optional<cuda::CopyRates>& rates) {
  show("built with CUDA   {}\n",
       probe.built ? "yes, run time " + cuda::version_text(probe.runtime) : std::string("no"));
  if (probe.built) show("driver            {}\n", version_or_none(probe.driver));
  if (!probe.card.empty()) {
    show("card              {}, compute capability {}.{}, {} of {} free\n", probe.card, probe.capability / 10,
         probe.capability % 10, exec::bytes_text(probe.free), exec::bytes_text(probe.memory));
  }
  show("usable            {}\n", probe.usable ? std::string("yes") : "no: " + probe.why);
  if (!rates) return;
  show("copies of {}: {:.0f} GB/s on the card (read and written), {:.1f} GB/s to it, {:.1f} GB/s from it\n",
       exec::bytes_text(rates->bytes), 1e-9 * rates->copy, 1e-9 * rates->upload, 1e-9 * rates->download);
}

/// The card that this build can use. exit_no_card without one. Errors: as measure_copies.
int device(const DeviceVerb& verb) {
  const DeviceProbe probe = cuda::probe_device();
  std::optional<cuda::CopyRates> rates;
  if (probe.usable && verb.measure) {
    rates =
        cuda::measure_copies(*cuda::make_device_executor(), std::min(std::size_t{1} << 30, probe.free / 4));
  }
  if (verb.json) {
    fmt::print("{}\n", as_json(probe, rates).dump(2));
  } else {
    print(probe, rates);
  }
  return probe.usable ? exit_ok : exit_no_card;
}

}  // namespace

Action verb::device(CLI::App& app) {
  const auto verb = std::make_shared<DeviceVerb>();
  app.add_flag("--json", verb->json, "as JSON");
  app.add_flag("--measure", verb->measure, "how fast copies are");
  return [verb](const CommonOptions&) { return cli::device(*verb); };
}

}  // namespace bb::cli

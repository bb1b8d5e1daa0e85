#include "core/math/stop_request.hpp"

#include <atomic>

namespace bb {
namespace {

std::atomic<StopRequest> current{nullptr};

}  // namespace

void set_stop_request(StopRequest request) { current.store(request); }

void heed_stop() {
  if (const StopRequest request = current.load()) request();
}

}  // namespace bb

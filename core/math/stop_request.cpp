#include "core/math/stop_request.hpp"

#include <atomic>

namespace bb {
namespace {

std::atomic<StopRequest> current{nullptr};
std::atomic<int> deferred{0};

}  // namespace

void set_stop_request(StopRequest request) { current.store(request); }

void heed_stop() {
  if (deferred.load() > 0) return;
  if (const StopRequest request = current.load()) request();
}

StopDeferred::StopDeferred() { ++deferred; }
StopDeferred::~StopDeferred() { --deferred; }

}  // namespace bb

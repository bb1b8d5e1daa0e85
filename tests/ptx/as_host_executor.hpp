// Included before the tests of a resident room when they are compiled for PTX: every executor of theirs runs both.
#pragma once

#include "tests/ptx/lockstep_executor.hpp"

namespace bb::exec {
class HostAndDevice final : public ptx::LockstepExecutor {
 public:
  explicit HostAndDevice(Order order = Order::forward, unsigned seed = 1) : LockstepExecutor(order, seed) {}
};
}  // namespace bb::exec
#define HostExecutor HostAndDevice

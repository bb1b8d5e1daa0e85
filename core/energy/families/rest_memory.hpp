// What elements remember from step to step: plastic parts, lengths that creep, stiffnesses of what breaks.
#pragma once

#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/exec/buffer.hpp"

namespace bb {

class RestMemory {
 public:
  RestMemory(exec::Executor& executor, const std::string& name)
      : now_(executor, name), next_(executor, name + " of the next step") {}
  void set(std::span<const double> values) { now_.upload(values); }
  /// Of the step.
  const double* data() const { return now_.data(); }
  std::vector<double> values() const { return now_.download(); }
  void copy_to(exec::Buffer<double>& out) const { out.copy_from(now_); }

  /// A step begins: what the one before has left holds.
  void begin_step() {
    if (flowed_) now_.copy_from(next_);
    flowed_ = false;
  }
  /// A step is over: what it leaves is what it had, for a kernel to change. Whoever looks at the step sees its own memory still.
  double* flow() {
    next_.copy_from(now_);
    flowed_ = true;
    return next_.data();
  }
  /// What the step has, and what it leaves once it is over.
  void keep(Archive& archive) {
    std::vector<double> now = now_.download(), next;
    if (flowed_) next = next_.download();
    archive(now, next);
    if (!archive.reads()) return;
    now_.upload(now);
    flowed_ = !next.empty();
    if (flowed_) next_.upload(next);
  }

 private:
  exec::Buffer<double> now_, next_;
  bool flowed_ = false;
};

}  // namespace bb

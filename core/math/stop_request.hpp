// Whether a stop of the program was requested while long work that has no limits of its own is under way: the scene is built, a
// system is set up. The program that handles signals defines how; where none does, work goes on to its end.
#pragma once

namespace bb {

/// Throws when the work should stop, and returns otherwise.
using StopRequest = void (*)();

/// From now on heed_stop() calls `request`; null: nothing.
void set_stop_request(StopRequest request);

/// To be called between the parts of long work, from code that may throw: not inside a parallel loop. Errors: those of the request.
void heed_stop();

/// While one lives, heed_stop() returns: a step of a run ends before the run does, so that its checkpoint is whole.
class StopDeferred {
 public:
  StopDeferred();
  ~StopDeferred();
  StopDeferred(const StopDeferred&) = delete;
  StopDeferred& operator=(const StopDeferred&) = delete;
};

}  // namespace bb

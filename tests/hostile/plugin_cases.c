/* Plugins that a loader must survive; BAD chooses one. 0 is a sound one. */
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "core/model/plugin/barrierbench_plugin.h"

enum {
  sound,
  null_array,
  wild_array,
  wild_name,
  many_entries,
  smoothness,
  flag,
  constructor_crashes,
  constructor_exits,
  constructor_hangs,
  null_plugin,
  entry_crashes,
  long_name
};

static void eval_double(void* self, size_t n, const double* d, const double* d_hat, double* b, double* db,
                        double* d2b) {
  (void)self;
  for (size_t i = 0; i < n; ++i) {
    const double e = d[i] < d_hat[i] ? d_hat[i] - d[i] : 0;
    b[i] = e * e, db[i] = -2 * e, d2b[i] = e > 0 ? 2 : 0;
  }
}
static void eval_float(void* self, size_t n, const float* d, const float* d_hat, float* b, float* db,
                       float* d2b) {
  (void)self;
  for (size_t i = 0; i < n; ++i) {
    const float e = d[i] < d_hat[i] ? d_hat[i] - d[i] : 0;
    b[i] = e * e, db[i] = -2 * e, d2b[i] = e > 0 ? 2 : 0;
  }
}

static char long_text[400];
static const bb_plugin_shape shapes[] = {{BAD == wild_name   ? (const char*)8
                                          : BAD == long_name ? long_text
                                                             : "hostile_shape",
                                          "", BAD == smoothness ? -7 : 1, BAD == flag ? 2 : 0, NULL,
                                          eval_double, eval_float}};
static const bb_plugin plugin = {BB_PLUGIN_ABI_VERSION,
                                 "hostile",
                                 BAD == many_entries ? (size_t)-1 : 1,
                                 BAD == null_array   ? NULL
                                 : BAD == wild_array ? (const bb_plugin_shape*)16
                                                     : shapes,
                                 0,
                                 NULL,
                                 0,
                                 NULL};

__attribute__((constructor)) static void start(void) {
  for (size_t i = 0; i + 1 < sizeof long_text; ++i) long_text[i] = 'a';
  if (BAD == constructor_crashes) raise(SIGSEGV);
  if (BAD == constructor_exits) exit(0);
  if (BAD == constructor_hangs) {
    for (;;) pause();
  }
}

const bb_plugin* barrierbench_plugin(void) {
  if (BAD == entry_crashes) abort();
  return BAD == null_plugin ? NULL : &plugin;
}

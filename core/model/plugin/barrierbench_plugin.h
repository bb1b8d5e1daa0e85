/* The plugin interface: shapes, stiffness policies and integrators from a shared library (--plugin FILE.so).
 * Plain C, batch calls over columns, SI units. A plugin exports one function, barrierbench_plugin, and
 * everything it returns lives as long as the process. Worked examples: examples/plugins/. */
#ifndef BARRIERBENCH_PLUGIN_H
#define BARRIERBENCH_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Raised with every change of a struct or of the meaning of a field; any other number is refused. */
#define BB_PLUGIN_ABI_VERSION 1u

/* A barrier shape, for kappa = 1: b (m^2), b' (m), b'' (1) in the unsquared gap d (m); exactly 0 for d >=
 * d_hat. Called with n >= 0 rows, d >= 0, d_hat > 0. d = 0: the limit (inf, -inf, inf where b is unbounded).
 * It must scale as b(s d; s d_hat) = s^2 b(d; d_hat), which is what makes kappa a stiffness in N/m. Called
 * from several threads. */
typedef struct bb_plugin_shape {
  const char* name; /* snake_case, not the name of another shape */
  const char* doc;
  int32_t smoothness_at_d_hat; /* number of continuous derivatives at d = d_hat, 0 to 1000 */
  int32_t infinite_at_zero;    /* 0 or 1; 1: b -> infinity as d -> 0 */
  void* self;                  /* handed to the calls */
  void (*eval_double)(void* self, size_t n, const double* d, const double* d_hat, double* b, double* db,
                      double* d2b);
  void (*eval_float)(void* self, size_t n, const float* d, const float* d_hat, float* b, float* db,
                     float* d2b);
} bb_plugin_shape;

/* Contact rows as a stiffness policy sees them: free vertices only; row r owns slots 4 r .. 4 r + n_free[r].
 */
typedef struct bb_plugin_rows {
  size_t n;
  const int32_t* n_free; /* [n] 1..4 */
  const double* weight;  /* [4 n] w_i, grad_i d = w_i normal */
  const double* normal;  /* [3 n] unit */
  const double* d;       /* [n] gap, m */
  const double* d_hat;   /* [n] m */
  const double* mass;    /* [4 n] lumped vertex masses, kg */
  const double*
      hessian; /* [144 n] 12 x 12 column-major PSD elastic Hessian blocks, N/m; NULL unless needs_hessian */
  double h;    /* time step, s */
  double c;    /* inertia weight M/(c h^2); 0: no inertia */
} bb_plugin_rows;

/* A stiffness policy: fills kappa (N/m, >= 0) of every row. When it is refreshed is the config's `refresh`.
 */
typedef struct bb_plugin_policy {
  const char* name;
  const char* doc;
  int32_t needs_hessian;
  void* self;
  void (*fill)(void* self, const bb_plugin_rows* rows, double* kappa);
} bb_plugin_policy;

/* States at the ends of the last two steps, [3 n] each, vertex-major. */
typedef struct bb_plugin_history {
  size_t n;             /* vertices */
  int64_t steps;        /* accepted steps */
  const double* x;      /* x_n, m */
  const double* v;      /* v_n, m/s */
  const double* a;      /* a_n, m/s^2; NULL unless needs_acceleration */
  const double* x_prev; /* x_{n-1}; NULL while steps < 1 */
  const double* v_prev; /* v_{n-1}; NULL while steps < 1 */
} bb_plugin_history;

/* An integrator: c > 0 and x_tilde of E(x) = 1/(2 c h^2) (x - x_tilde)^T M (x - x_tilde) - f^T (x - x_n) +
 * ..., x_tilde without any force; then v and a at the x that the step reached. */
typedef struct bb_plugin_integrator {
  const char* name;
  const char* doc;
  int32_t needs_acceleration; /* 1: a_0 is computed from the forces at the start, and a kept */
  void* self;
  void (*predict)(void* self, const bb_plugin_history* history, double h, double* c, double* x_tilde);
  void (*finish)(void* self, const bb_plugin_history* history, double h, double c, const double* x_tilde,
                 const double* x, double* v, double* a);
} bb_plugin_integrator;

/* What the library holds. Counts are 0 to 1000; the array of a count of 0 may be NULL. */
typedef struct bb_plugin {
  uint32_t abi_version; /* BB_PLUGIN_ABI_VERSION of the header it was built with; read before anything else */
  const char* name;
  size_t n_shapes;
  const bb_plugin_shape* shapes;
  size_t n_policies;
  const bb_plugin_policy* policies;
  size_t n_integrators;
  const bb_plugin_integrator* integrators;
} bb_plugin;

/* The one exported function; not NULL. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const bb_plugin*
barrierbench_plugin(void);

#ifdef __cplusplus
}
#endif

#endif

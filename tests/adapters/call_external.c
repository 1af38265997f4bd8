/* SPDX-License-Identifier: Apache-2.0
 * Calls the functions of a programme as CasADi's `external` does: call LIBRARY NAME < POINTS. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long long int casadi_int;

static void* library;
static const char* prefix;

static void fail(const char* what, const char* which) {
  fprintf(stderr, "call: %s: %s\n", which, what);
  exit(1);
}

static void* symbol(const char* function, const char* suffix) {
  char name[256];
  void* found;
  snprintf(name, sizeof name, "%s%s", function, suffix);
  found = dlsym(library, name);
  if (!found) fail("no such symbol", name);
  return found;
}

/* A function with the room that it wants. */
typedef struct {
  int (*call)(const double**, double**, casadi_int*, double*, int);
  const double* arg[4];
  double* res[5];
  double* w;
  int mem;
  casadi_int size[5];
  const casadi_int* pattern[5];
} Function;

static Function function(const char* before, const char* after, int inputs, int outputs,
                         const char* const* names) {
  Function f;
  char name[256];
  casadi_int sz_arg, sz_res, sz_iw, sz_w, i;
  union {
    void* found;
    casadi_int (*count)(void);
    const char* (*name)(casadi_int);
    const casadi_int* (*pattern)(casadi_int);
    int (*work)(casadi_int*, casadi_int*, casadi_int*, casadi_int*);
    int (*whole)(void);
    int (*begin)(int);
    void (*reference)(void);
    int (*call)(const double**, double**, casadi_int*, double*, int);
  } u;
  memset(&f, 0, sizeof f);
  snprintf(name, sizeof name, "%s%s%s", before, prefix, after);
  u.found = symbol(name, "_incref");
  u.reference();
  u.found = symbol(name, "_n_in");
  if (u.count() != inputs) fail("another number of inputs", name);
  u.found = symbol(name, "_n_out");
  if (u.count() != outputs) fail("another number of outputs", name);
  u.found = symbol(name, "_name_out");
  for (i = 0; i < outputs; ++i) {
    if (strcmp(u.name(i), names[i]) != 0) fail("another name of an output", name);
  }
  if (u.name(outputs) != NULL) fail("a name too many", name);
  u.found = symbol(name, "_name_in");
  if (inputs > 0 && strcmp(u.name(0), "x") != 0) fail("another name of an input", name);
  u.found = symbol(name, "_sparsity_in");
  if (inputs > 1 && u.pattern(1)[0] * u.pattern(1)[1] != 0) fail("p is not empty", name);
  u.found = symbol(name, "_sparsity_out");
  for (i = 0; i < outputs; ++i) {
    f.pattern[i] = u.pattern(i);
    f.size[i] = f.pattern[i][2 + f.pattern[i][1]];
    f.res[i] = calloc((size_t)f.size[i] + 1, sizeof(double));
  }
  u.found = symbol(name, "_work");
  if (u.work(&sz_arg, &sz_res, &sz_iw, &sz_w)) fail("work", name);
  if (sz_arg < inputs || sz_res < outputs || sz_iw != 0) fail("too little room", name);
  f.w = calloc((size_t)sz_w + 1, sizeof(double));
  u.found = symbol(name, "_alloc_mem");
  f.mem = u.whole();
  u.found = symbol(name, "_init_mem");
  if (u.begin(f.mem)) fail("init_mem", name);
  u.found = symbol(name, "_checkout");
  f.mem = u.whole();
  u.found = symbol(name, "");
  f.call = u.call;
  return f;
}

static int call(Function* f) { return f->call(f->arg, f->res, NULL, f->w, f->mem); }

static void print(const double* values, casadi_int count) {
  casadi_int i;
  for (i = 0; i < count; ++i) printf("%.17g ", values[i]);
  printf("\n");
}

int main(int argc, char** argv) {
  static const char* const f_g[] = {"f", "g", "grad_gamma_x", "grad_gamma_p"};
  static const char* const grad_f[] = {"f", "grad_f_x"};
  static const char* const jac_g[] = {"g", "jac_g_x"};
  static const char* const jac[] = {"jac_f_x", "jac_f_p", "jac_g_x", "jac_g_p"};
  static const char* const data[] = {"x0", "lbx", "ubx", "lbg", "ubg"};
  Function whole, f, g, gradient, jacobian, lagrangian, derivatives, problem;
  casadi_int n, m, nonzeros, i, count;
  double *x, *ones, one = 2.0;
  if (argc != 3) fail("expected LIBRARY NAME", argv[0]);
  library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (!library) fail(dlerror(), argv[1]);
  prefix = argv[2];
  whole = function("", "", 2, 2, f_g);
  f = function("", "_f", 2, 1, f_g);
  g = function("", "_g", 2, 1, jac_g);
  gradient = function("", "_grad_f", 2, 2, grad_f);
  jacobian = function("", "_jac_g", 2, 2, jac_g);
  lagrangian = function("", "_grad", 4, 4, f_g);
  derivatives = function("jac_", "", 4, 4, jac);
  problem = function("", "_problem", 0, 5, data);
  n = gradient.size[1];
  m = whole.size[1];
  nonzeros = jacobian.size[1];
  if (jacobian.pattern[1][0] != m || jacobian.pattern[1][1] != n) fail("another shape", prefix);
  printf("%lld %lld %lld\n", n, m, nonzeros);
  for (i = 0; i <= n + nonzeros; ++i) printf("%lld ", jacobian.pattern[1][2 + i]);
  printf("\n");
  if (call(&problem)) fail("failed", "problem");
  for (i = 0; i < 5; ++i) print(problem.res[i], problem.size[i]);
  x = calloc((size_t)n, sizeof(double));
  ones = calloc((size_t)m + 1, sizeof(double));
  for (i = 0; i < m; ++i) ones[i] = 3.0;
  if (scanf("%lld", &count) != 1) fail("expected a number of points", prefix);
  while (count-- > 0) {
    int code;
    for (i = 0; i < n; ++i) {
      if (scanf("%lf", &x[i]) != 1) fail("expected a point", prefix);
    }
    whole.arg[0] = f.arg[0] = g.arg[0] = gradient.arg[0] = x;
    jacobian.arg[0] = lagrangian.arg[0] = derivatives.arg[0] = x;
    lagrangian.arg[2] = &one;
    lagrangian.arg[3] = ones;
    code = call(&whole) | call(&f) | call(&g) | call(&gradient) | call(&jacobian) |
           call(&lagrangian) | call(&derivatives);
    /* The same value, whichever function tells it. */
    if (!code) {
      if (memcmp(whole.res[0], f.res[0], sizeof(double)) ||
          memcmp(whole.res[1], g.res[0], (size_t)m * sizeof(double)) ||
          memcmp(gradient.res[1], derivatives.res[0], (size_t)n * sizeof(double)) ||
          memcmp(jacobian.res[1], derivatives.res[2], (size_t)nonzeros * sizeof(double))) {
        fail("two functions tell two values", prefix);
      }
      /* Results that nobody wants. */
      {
        double* kept = whole.res[0];
        whole.res[0] = NULL;
        if (call(&whole)) fail("failed without f", prefix);
        whole.res[0] = kept;
      }
    }
    printf("%d\n", code);
    print(whole.res[0], 1);
    print(whole.res[1], m);
    print(gradient.res[1], n);
    print(jacobian.res[1], nonzeros);
    print(lagrangian.res[2], n);
  }
  return 0;
}

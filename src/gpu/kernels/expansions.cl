// Points to multipoles and locals to points, one work-group per leaf. The counterpart of cpu/points_to_multipole.cpp and
// cpu/local_to_points.cpp; docs/math.md, "Expansions".
//
// A multipole is made of plain sums of the basis B_b, and its gradients are put together at the end; the value and the gradient of a local
// are sums of B_b as well, by coefficients that are put together at the beginning. So both are passes of at most four sums over B_b.
//
// The program says: FORM, BATCH (K), LOCAL_WIDTHS.
#define STOKES_LOCALS 9        // cpu::kStokesLocals
#define TRANSPOSED_WINDING 8   // cpu::kTransposedWinding
#if FORM == GREEN
#define MULTIPOLES BATCH
#define LOCALS BATCH
#define CHANNELS BATCH
#define TARGET_DATA 0
#define UP_PARTS BATCH
#define DOWN_PASSES BATCH
#define FIRST_SUM 0
#define SUMS 4
#elif FORM == GREEN_ADJOINT
#define MULTIPOLES BATCH
#define LOCALS BATCH
#define CHANNELS (BATCH + 3)
#define TARGET_DATA BATCH
#define UP_PARTS BATCH
#define DOWN_PASSES BATCH
#define FIRST_SUM 0
#define SUMS 1
#elif FORM == STOKES_WINDING
#define MULTIPOLES (8 + LOCAL_WIDTHS)
#define LOCALS (9 + LOCAL_WIDTHS)
#define CHANNELS 4
#define TARGET_DATA 0
#define UP_PARTS (4 + LOCAL_WIDTHS)
#define DOWN_PASSES 5
#define FIRST_SUM 0
#define SUMS 4
#else
#define MULTIPOLES 1
#define LOCALS 1
#define TARGET_DATA 0
#define UP_PARTS 1
#define DOWN_PASSES 1
#if FORM == WINDING
#define CHANNELS 1
#define FIRST_SUM 1
#define SUMS 4
#elif FORM == WINDING_ADJOINT
#define CHANNELS 3
#define FIRST_SUM 0
#define SUMS 1
#else
#define CHANNELS 3
#define FIRST_SUM 1
#define SUMS 4
#endif
#endif
#define HAS_VALUE (FORM != WINDING_ADJOINT && FORM != WINDING_GRADIENT)
#define HAS_GRADIENT (FORM != GREEN && FORM != WINDING)

// Index of Re R_l^m (m >= 0) and Im R_l^m (m > 0).
FUNCTION int real_index(int l, int m) { return l * l + (m == 0 ? 0 : 2 * m - 1); }
FUNCTION int imaginary_index(int l, int m) { return l * l + 2 * m; }

// The degree, order and part of a coefficient.
typedef struct {
  int l, m;
  int imaginary;
} Place;

FUNCTION Place place_of(int index) {
  Place p;
  p.l = 0;
  while ((p.l + 1) * (p.l + 1) <= index) ++p.l;
  const int rest = index - p.l * p.l;
  p.m = (rest + 1) / 2;
  p.imaginary = rest > 0 && rest % 2 == 0;
  return p;
}

// An element of one degree, 0 where there is none.
FUNCTION real at(const LOCAL real* s, int l, int m, int imaginary) {
  if (m > l || (imaginary && m == 0)) return 0;
  return s[imaginary ? imaginary_index(l, m) : real_index(l, m)];
}

// sum_b (d/dx B_a)_b x_b + (d/dy B_a)_b y_b + (d/dz B_a)_b z_b, B_b of one degree less:
//   g . grad R_l^m = g_z R_{l-1}^m - (g_x + i g_y)/2 R_{l-1}^{m-1} + (g_x - i g_y)/2 R_{l-1}^{m+1}
FUNCTION real along_gradient(const LOCAL real* x, const LOCAL real* y, const LOCAL real* z, int a) {
  const Place p = place_of(a);
  const int l = p.l - 1;
  if (l < 0) return 0;
  if (p.m == 0) return at(x, l, 1, 0) + at(y, l, 1, 1) + at(z, l, 0, 0);
  const real a_half = (real)0.5;
  if (!p.imaginary) {
    return a_half * (at(x, l, p.m + 1, 0) - at(x, l, p.m - 1, 0)) + a_half * (at(y, l, p.m + 1, 1) + at(y, l, p.m - 1, 1)) +
           at(z, l, p.m, 0);
  }
  return a_half * (at(x, l, p.m + 1, 1) - at(x, l, p.m - 1, 1)) - a_half * (at(y, l, p.m + 1, 0) + at(y, l, p.m - 1, 0)) + at(z, l, p.m, 1);
}

// The transposed: coefficient b of the derivative along `axis` of sum_a c_a B_a.
FUNCTION real derivative(const LOCAL real* c, int order, int axis, Place p) {
  const int l = p.l + 1;
  if (l > order) return 0;
  if (axis == 2) return at(c, l, p.m, p.imaginary);
  const real a_half = (real)0.5;
  const real below = p.m == 1 ? (real)1 : a_half;  // of what comes from order 0
  if (axis == 0) return (p.m > 0 ? below * at(c, l, p.m - 1, p.imaginary) : 0) - a_half * at(c, l, p.m + 1, p.imaginary);
  if (p.imaginary) return below * at(c, l, p.m - 1, 0) + a_half * at(c, l, p.m + 1, 0);
  return -a_half * (at(c, l, p.m + 1, 1) + (p.m > 1 ? at(c, l, p.m - 1, 1) : 0));
}

// R_{l+1}^m = up z R_l^m - down r^2 R_{l-1}^m. The numbers up and down are at 2 (l^2 + m) and after it.
FUNCTION void make_factors(int order, LOCAL real* factors) {
  for (int l = ITEM; l <= order; l += GROUP) {
    for (int m = 0; m <= l; ++m) {
      const real divisor = (real)((l + 1 + m) * (l + 1 - m));
      factors[2 * (l * l + m)] = (real)(2 * l + 1) / divisor;
      factors[2 * (l * l + m) + 1] = (real)1 / divisor;
    }
  }
}

// Weights of a source in the four sums of one part of its multipole: w[0] of B, w[1..3] of the gradient (times the half side).
FUNCTION void source_weights(const GLOBAL real* values, uint stride, int part, real x, real y, real z, real width2, real* w) {
  const size_t s = stride;
#if FORM == GREEN_ADJOINT || FORM == WINDING_ADJOINT
  w[0] = values[(size_t)part * s];
#else
  real scale = 1;
  w[0] = 0;
#if FORM == GREEN
  w[0] = values[(size_t)(3 + 2 * part) * s];
  scale = values[(size_t)(4 + 2 * part) * s];
#elif FORM == STOKES_WINDING
  if (part == 0) w[0] = FMA(x, values[0], FMA(y, values[s], z * values[2 * s]));
  if (part > 0 && part < 4) {
    w[0] = values[(size_t)(part - 1) * s];
    scale = part == 1 ? x : (part == 2 ? y : z);
  }
  if (part == 4) scale = width2;
#endif
  w[1] = scale * values[0];
  w[2] = scale * values[s];
  w[3] = scale * values[2 * s];
#endif
}

// From B_a to B_{a+1} of a tile of `points` points: where items read one point of many a, all are in banks of their own.
#define PITCH(points) (LANES == 1 ? (points) + 1 : (points))

// B_a of a tile of points: an item does one order m for a vector of points.
FUNCTION void fill_basis(int order, int points, const LOCAL real* position, const LOCAL real* factors, LOCAL real* basis) {
  const int vectors = points / LANES;
  for (int i = ITEM; i < (order + 1) * vectors; i += GROUP) {
    const int m = i / vectors;
    const int p = i % vectors * LANES;
    const lanes x = LOAD(position + p);
    const lanes y = LOAD(position + points + p);
    const lanes z = LOAD(position + 2 * points + p);
    const lanes r2 = FMA(x, x, FMA(y, y, z * z));
    lanes re = SPLAT(1);
    lanes im = SPLAT(0);
    for (int k = 1; k <= m; ++k) {  // times -(x + iy) / (2k)
      const lanes scale = SPLAT((real)-0.5 / (real)k);
      const lanes next = scale * FMA(-y, im, x * re);
      im = scale * FMA(x, im, y * re);
      re = next;
    }
    lanes re_below = SPLAT(0);
    lanes im_below = SPLAT(0);
    for (int l = m; l <= order; ++l) {
      STORE(re, basis + real_index(l, m) * PITCH(points) + p);
      if (m > 0) STORE(im, basis + imaginary_index(l, m) * PITCH(points) + p);
      const lanes up = SPLAT(factors[2 * (l * l + m)]) * z;
      const lanes down = SPLAT(factors[2 * (l * l + m) + 1]) * r2;
      const lanes re_next = FMA(-down, re_below, up * re);
      const lanes im_next = FMA(-down, im_below, up * im);
      re_below = re;
      im_below = im;
      re = re_next;
      im = im_next;
    }
  }
}

// Work-group g does part g % UP_PARTS of the multipoles of source leaf first_leaf + g / UP_PARTS. `points`: of a tile, a multiple of LANES.
// Geometry and values as in near_field(). Shared: points * (n + 7) + 7 n numbers, n = (order + 1)^2.
KERNEL points_to_multipoles(int first_leaf, const GLOBAL uint2* leaves, const GLOBAL uint* leaf_nodes, const GLOBAL int4* centres,
                            const GLOBAL real* geometry, const GLOBAL real* values, uint field_stride, int order, int stride,
                            int points, GLOBAL real* multipoles SHARED_ARGUMENT) {
  SHARED(shared);
  const int leaf = first_leaf + GROUP_INDEX / UP_PARTS;
  const int part = GROUP_INDEX % UP_PARTS;
  const int n = (order + 1) * (order + 1);
  LOCAL real* basis = shared;                        // n x points
  LOCAL real* weights = basis + n * PITCH(points);   // 4 x points
  LOCAL real* position = weights + 4 * points;       // 3 x points, in half sides
  LOCAL real* sums = position + 3 * points;          // 4 x n
  LOCAL real* factors = sums + 4 * n;                // 2 x n
  const int count = (int)leaves[leaf].y;
  const uint first_point = leaves[leaf].x;
  const real unit = (real)(1 << centres[leaf].w);  // 1 / half side
  for (int i = ITEM; i < 4 * n; i += GROUP) sums[i] = 0;
  make_factors(order, factors);
  for (int begin = 0; begin < count; begin += points) {
    BARRIER();
    for (int p = ITEM; p < points; p += GROUP) {
      real w[4] = {0, 0, 0, 0};
      real x = 0;
      real y = 0;
      real z = 0;
      if (begin + p < count) {
        const size_t at_point = first_point + (uint)(begin + p);
        x = geometry[at_point];
        y = geometry[field_stride + at_point];
        z = geometry[2 * (size_t)field_stride + at_point];
        source_weights(values + at_point, field_stride, part, x, y, z,
                       LOCAL_WIDTHS ? geometry[3 * (size_t)field_stride * LOCAL_WIDTHS + at_point] : 0, w);
      }
      position[p] = unit * x;
      position[points + p] = unit * y;
      position[2 * points + p] = unit * z;
      for (int q = 0; q < 4; ++q) weights[q * points + p] = w[q];
    }
    BARRIER();
    fill_basis(order, points, position, factors, basis);
    BARRIER();
    int q = FIRST_SUM;
    for (int b = ITEM; q < SUMS; b += GROUP) {
      for (; b >= n; b -= n) ++q;
      if (q >= SUMS) break;
      lanes sum = SPLAT(0);
      for (int p = 0; p < points; p += LANES) sum = FMA(LOAD(basis + b * PITCH(points) + p), LOAD(weights + q * points + p), sum);
      sums[q * n + b] += sum_of(sum);
    }
  }
  BARRIER();
  GLOBAL real* multipole = multipoles + (size_t)leaf_nodes[leaf] * MULTIPOLES * (size_t)stride;
  for (int a = ITEM; a < stride; a += GROUP) {
    const int within = a < n;
    real of_gradient = 0;
    if (SUMS == 4 && within) of_gradient = -unit * along_gradient(sums + n, sums + 2 * n, sums + 3 * n, a);
#if FORM == STOKES_WINDING
    const real value = within ? sums[a] : 0;
    if (part == 0) {
      multipole[a] = of_gradient;                                                               // W
      for (int k = 1; k < 4; ++k) multipole[(3 + k) * stride + a] = within ? sums[k * n + a] : 0;  // P_k
      multipole[7 * stride + a] = value;                                                        // Q
    } else if (part < 4) {
      multipole[part * stride + a] = value + of_gradient;  // E_a
    } else {
      multipole[8 * stride + a] = of_gradient;  // W of width^2 eta
    }
#else
    multipole[part * stride + a] = (FIRST_SUM == 0 && within ? sums[a] : 0) + of_gradient;
#endif
  }
}

// sum_b of four expansions, n apart in `c`, at one vector of points: value and gradient.
typedef struct {
  lanes value, x, y, z;
} Evaluated;

FUNCTION Evaluated evaluate(const LOCAL real* c, const LOCAL real* factors, int n, int order, lanes x, lanes y, lanes z) {
  Evaluated e;
  e.value = e.x = e.y = e.z = SPLAT(0);
  const lanes r2 = FMA(x, x, FMA(y, y, z * z));
  lanes re_diagonal = SPLAT(1);
  lanes im_diagonal = SPLAT(0);
  for (int m = 0; m <= order; ++m) {
    if (m > 0) {  // times -(x + iy) / (2m)
      const lanes scale = SPLAT((real)-0.5 / (real)m);
      const lanes next = scale * FMA(-y, im_diagonal, x * re_diagonal);
      im_diagonal = scale * FMA(x, im_diagonal, y * re_diagonal);
      re_diagonal = next;
    }
    lanes re = re_diagonal;
    lanes im = im_diagonal;
    lanes re_below = SPLAT(0);
    lanes im_below = SPLAT(0);
    for (int l = m; l <= order; ++l) {
      const LOCAL real* at_re = c + real_index(l, m);
      const LOCAL real* at_im = m > 0 ? at_re + 1 : at_re;  // times 0 for m = 0
#if HAS_VALUE
      e.value = FMA(SPLAT(at_re[0]), re, FMA(SPLAT(at_im[0]), im, e.value));
#endif
#if HAS_GRADIENT
      e.x = FMA(SPLAT(at_re[n]), re, FMA(SPLAT(at_im[n]), im, e.x));
      e.y = FMA(SPLAT(at_re[2 * n]), re, FMA(SPLAT(at_im[2 * n]), im, e.y));
      e.z = FMA(SPLAT(at_re[3 * n]), re, FMA(SPLAT(at_im[3 * n]), im, e.z));
#endif
      const lanes up = SPLAT(factors[2 * (l * l + m)]) * z;
      const lanes down = SPLAT(factors[2 * (l * l + m) + 1]) * r2;
      const lanes re_next = FMA(-down, re_below, up * re);
      const lanes im_next = FMA(-down, im_below, up * im);
      re_below = re;
      im_below = im;
      re = re_next;
      im = im_next;
    }
  }
  return e;
}

// The expansions whose value and gradient a pass needs. Those of S, docs/math.md, "The Stokes far field":
//   0: value W of all pairs, gradient Q - e^2 W (local widths: Q - half of the W of e^2 eta)
//   1..3: value E_a + P_a, gradient P_a      4: value W of the pairs that use E, gradient W of all pairs (local widths)
FUNCTION real value_coefficient(const GLOBAL real* local_, int stride, int pass, int a) {
#if FORM == STOKES_WINDING
  if (pass == 0) return local_[a] + local_[TRANSPOSED_WINDING * stride + a];
  if (pass < 4) return local_[pass * stride + a] + local_[(3 + pass) * stride + a];
  return local_[a];
#else
  return local_[pass * stride + a];
#endif
}
FUNCTION real gradient_coefficient(const GLOBAL real* local_, int stride, int pass, real uniform_width2, int a) {
#if FORM == STOKES_WINDING
  const real all = local_[a] + local_[TRANSPOSED_WINDING * stride + a];
  if (pass == 0) {
    return FMA(LOCAL_WIDTHS ? (real)-0.5 : -uniform_width2, LOCAL_WIDTHS ? local_[STOKES_LOCALS * stride * LOCAL_WIDTHS + a] : all,
               local_[7 * stride + a]);
  }
  if (pass < 4) return local_[(3 + pass) * stride + a];
  return LOCAL_WIDTHS ? all : 0;
#else
  return local_[pass * stride + a];
#endif
}

// Adds what a pass contributes at one vector of targets to the channels of the result.
FUNCTION void add_pass(int pass, Evaluated e, real unit, lanes x, lanes y, lanes z, lanes width2, const GLOBAL real* data, lanes* out) {
  const lanes value = SPLAT(unit) * e.value;
  const lanes gx = SPLAT(unit * unit) * e.x;
  const lanes gy = SPLAT(unit * unit) * e.y;
  const lanes gz = SPLAT(unit * unit) * e.z;
#if FORM == GREEN || FORM == WINDING
  out[0] = value;
#elif FORM == GREEN_ADJOINT
  const lanes u = LOAD(data);
  UNROLL for (int k = 0; k < BATCH; ++k) out[k] = k == pass ? value : out[k];
  out[BATCH] = FMA(u, gx, out[BATCH]);
  out[BATCH + 1] = FMA(u, gy, out[BATCH + 1]);
  out[BATCH + 2] = FMA(u, gz, out[BATCH + 2]);
#elif FORM == WINDING_ADJOINT
  out[0] = gx;
  out[1] = gy;
  out[2] = gz;
#elif FORM == WINDING_GRADIENT
  out[0] = -gx;
  out[1] = -gy;
  out[2] = -gz;
#else
  lanes along = SPLAT(1);
  if (pass == 0) {
    out[3] = value;
  } else if (pass < 4) {
    along = -(pass == 1 ? x : (pass == 2 ? y : z));
    out[0] += pass == 1 ? value : SPLAT(0);
    out[1] += pass == 2 ? value : SPLAT(0);
    out[2] += pass == 3 ? value : SPLAT(0);
  } else {
    along = SPLAT((real)-0.5) * width2;
    out[0] = FMA(-x, value, out[0]);
    out[1] = FMA(-y, value, out[1]);
    out[2] = FMA(-z, value, out[2]);
  }
  out[0] = FMA(along, gx, out[0]);
  out[1] = FMA(along, gy, out[1]);
  out[2] = FMA(along, gz, out[2]);
#endif
}

// Work-group g does target leaf first_leaf + g and adds to out: blocks x CHANNELS x BLOCK. Leaves, targets and their data as in near_field().
// Shared: 7 n numbers.
KERNEL locals_to_points(int first_leaf, const GLOBAL uint2* leaves, const GLOBAL uint* leaf_nodes, const GLOBAL int4* centres,
                        const GLOBAL real* targets_, const GLOBAL real* target_data, uint target_stride, int order, int stride,
                        real uniform_width2, const GLOBAL real* locals, GLOBAL real* out SHARED_ARGUMENT) {
  SHARED(shared);
  const int leaf = first_leaf + GROUP_INDEX;
  const int n = (order + 1) * (order + 1);
  LOCAL real* coefficients = shared;    // 4 x n
  LOCAL real* combined = shared + 4 * n;
  LOCAL real* factors = shared + 5 * n;  // 2 x n
  const int count = (int)leaves[leaf].y;
  const real unit = (real)(1 << centres[leaf].w);
  const GLOBAL real* local_ = locals + (size_t)leaf_nodes[leaf] * LOCALS * (size_t)stride;
  make_factors(order, factors);
  for (int begin = 0; begin < count; begin += GROUP * LANES) {
    const int target = begin + ITEM * LANES;
    const int last = (count - 1) / LANES * LANES;
    const size_t at = leaves[leaf].x + (uint)(target < last ? target : last);
    const lanes x = LOAD(targets_ + at);
    const lanes y = LOAD(targets_ + target_stride + at);
    const lanes z = LOAD(targets_ + 2 * (size_t)target_stride + at);
    const lanes width2 = LOCAL_WIDTHS ? LOAD(targets_ + 3 * (size_t)target_stride * LOCAL_WIDTHS + at) : SPLAT(0);
    lanes sum[CHANNELS];
    UNROLL for (int c = 0; c < CHANNELS; ++c) sum[c] = SPLAT(0);
    for (int pass = 0; pass < DOWN_PASSES; ++pass) {
      BARRIER();
      for (int a = ITEM; a < n; a += GROUP) {
        coefficients[a] = value_coefficient(local_, stride, pass, a);
        combined[a] = gradient_coefficient(local_, stride, pass, uniform_width2, a);
      }
      BARRIER();
#if HAS_GRADIENT
      for (int b = ITEM; b < n; b += GROUP) {
        const Place p = place_of(b);
        UNROLL for (int axis = 0; axis < 3; ++axis) coefficients[(1 + axis) * n + b] = derivative(combined, order, axis, p);
      }
      BARRIER();
#endif
      const Evaluated e = evaluate(coefficients, factors, n, order, SPLAT(unit) * x, SPLAT(unit) * y, SPLAT(unit) * z);
      const GLOBAL real* data = target_data + (size_t)pass * target_stride + at;
#if FORM == GREEN
      lanes one[1];
      add_pass(pass, e, unit, x, y, z, width2, data, one);
      UNROLL for (int k = 0; k < BATCH; ++k) sum[k] = k == pass ? one[0] : sum[k];
#else
      add_pass(pass, e, unit, x, y, z, width2, data, sum);
#endif
    }
    UNROLL for (int c = 0; c < CHANNELS; ++c) {
      real one[LANES];
      STORE(sum[c], one);
      for (int i = 0; i < LANES && target + i < count; ++i) {
        out[((at + (size_t)i) / BLOCK * CHANNELS + (size_t)c) * BLOCK + (at + (size_t)i) % BLOCK] += one[i];
      }
    }
  }
}

// Points to multipoles and locals to points, one work-group per leaf. The counterpart of cpu/points_to_multipole.cpp and
// cpu/local_to_points.cpp; docs/math.md, "Expansions".
//
// A multipole is made of plain sums of the basis B_b, and its gradients are put together at the end; the value and the gradient of a local
// are sums of B_b as well, which a target makes once for several expansions.
//
// The program says: FORM, BATCH (K), LOCAL_WIDTHS.
#define STOKES_LOCALS 9        // cpu::kStokesLocals
#define TRANSPOSED_WINDING 8   // cpu::kTransposedWinding
// What follows says of every form:
//   TOGETHER: parts of a multipole, of UP_PARTS, that a work-group does with one basis; of doubles one, for want of local memory
//   FIRST_SUM to SUMS: the sums of a part that are needed
//   VALUES, GRADIENTS: of how many expansions locals_to_points() needs values, and gradients; FUSED: how many it evaluates at a time
#if FORM == GREEN
#define MULTIPOLES BATCH
#define LOCALS BATCH
#define CHANNELS BATCH
#define UP_PARTS BATCH
#define TOGETHER (REAL_IS_DOUBLE ? 1 : BATCH % 3 == 0 ? 3 : BATCH)
#define FIRST_SUM 0
#define SUMS 4
#define VALUES BATCH
#define GRADIENTS 0
#define FUSED BATCH
#elif FORM == GREEN_ADJOINT
#define MULTIPOLES BATCH
#define LOCALS BATCH
#define CHANNELS (BATCH + 3)
#define UP_PARTS BATCH
#define TOGETHER (REAL_IS_DOUBLE ? 1 : BATCH % 3 == 0 ? 3 : BATCH)
#define FIRST_SUM 0
#define SUMS 1
#define VALUES BATCH
#define GRADIENTS BATCH
#define FUSED (BATCH % 3 == 0 ? 3 : BATCH)
#elif FORM == STOKES_WINDING
#define MULTIPOLES (8 + LOCAL_WIDTHS)
#define LOCALS (9 + LOCAL_WIDTHS)
#define CHANNELS 4
#define UP_PARTS (4 + LOCAL_WIDTHS)
#define TOGETHER (REAL_IS_DOUBLE ? 1 : UP_PARTS)
#define FIRST_SUM 0
#define SUMS 4
#define VALUES 5
#define GRADIENTS (4 + LOCAL_WIDTHS)
#define FUSED 5
#else
#define MULTIPOLES 1
#define LOCALS 1
#define UP_PARTS 1
#define TOGETHER 1
#define FUSED 1
#if FORM == WINDING
#define CHANNELS 1
#define FIRST_SUM 1
#define SUMS 4
#define VALUES 1
#define GRADIENTS 0
#elif FORM == WINDING_ADJOINT
#define CHANNELS 3
#define FIRST_SUM 0
#define SUMS 1
#define VALUES 0
#define GRADIENTS 1
#else
#define CHANNELS 3
#define FIRST_SUM 1
#define SUMS 4
#define VALUES 0
#define GRADIENTS 1
#endif
#endif

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
FUNCTION real along_gradient(const LOCAL real* x, const LOCAL real* y, const LOCAL real* z, Place p) {
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

// R_{l+1}^m = up z R_l^m - down r^2 R_{l-1}^m. The numbers up and down are at 2 (l^2 + m) and after it.
FUNCTION void make_factors(int order, LOCAL real* factors) {
  for (int i = ITEM; i < (order + 1) * (order + 1); i += GROUP) {
    const int l = place_of(i).l;
    const int m = i - l * l;
    if (m > l) continue;
    const real divisor = (real)((l + 1 + m) * (l + 1 - m));
    factors[2 * i] = (real)(2 * l + 1) / divisor;
    factors[2 * i + 1] = (real)1 / divisor;
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

// B_a of the first `count` points of a tile, a multiple of LANES: an item does one order m for a vector of points.
FUNCTION void fill_basis(int order, int count, int points, const LOCAL real* position, const LOCAL real* factors, LOCAL real* basis) {
  const int vectors = count / LANES;
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

// Work-group g does TOGETHER parts of the multipoles of a source leaf, from first_leaf on. `points`: of a tile, a multiple of LANES.
// Geometry and values as in near_field(). Shared: points * (n + 3 + TOGETHER * EACH) + n * (3 + TOGETHER * EACH) numbers,
// n = (order + 1)^2.
#define EACH (SUMS - FIRST_SUM)
#define SUM_OF(k, q) ((k) * EACH + (q) - FIRST_SUM)
KERNEL points_to_multipoles(int first_leaf, const GLOBAL uint2* leaves, const GLOBAL uint* leaf_nodes, const GLOBAL int4* centres,
                            const GLOBAL real* geometry, const GLOBAL real* values, uint field_stride, int order, int stride,
                            int points, GLOBAL real* multipoles SHARED_ARGUMENT) {
  SHARED(shared);
  const int leaf = first_leaf + GROUP_INDEX / (UP_PARTS / TOGETHER);
  const int first_part = GROUP_INDEX % (UP_PARTS / TOGETHER) * TOGETHER;
  const int n = (order + 1) * (order + 1);
  LOCAL real* basis = shared;                                   // n x points
  LOCAL real* weights = basis + n * PITCH(points);              // TOGETHER x EACH x points
  LOCAL real* position = weights + TOGETHER * EACH * points;    // 3 x points, in half sides
  LOCAL real* sums = position + 3 * points;                     // TOGETHER x EACH x n
  LOCAL real* factors = sums + TOGETHER * EACH * n;             // 2 x n
  const int count = (int)leaves[leaf].y;
  const uint first_point = leaves[leaf].x;
  const real unit = (real)(1 << centres[leaf].w);  // 1 / half side
  for (int i = ITEM; i < TOGETHER * EACH * n; i += GROUP) sums[i] = 0;
  make_factors(order, factors);
  for (int begin = 0; begin < count; begin += points) {
    const int some = count - begin < points ? (count - begin + LANES - 1) / LANES * LANES : points;
    BARRIER();
    for (int p = ITEM; p < some; p += GROUP) {
      const int there = begin + p < count;
      const size_t at_point = first_point + (uint)(there ? begin + p : 0);
      const real x = there ? geometry[at_point] : 0;
      const real y = there ? geometry[field_stride + at_point] : 0;
      const real z = there ? geometry[2 * (size_t)field_stride + at_point] : 0;
      const real width2 = LOCAL_WIDTHS ? geometry[3 * (size_t)field_stride * LOCAL_WIDTHS + at_point] : 0;
      position[p] = unit * x;
      position[points + p] = unit * y;
      position[2 * points + p] = unit * z;
      for (int k = 0; k < TOGETHER; ++k) {
        real w[4];
        source_weights(values + at_point, field_stride, first_part + k, x, y, z, width2, w);
        UNROLL for (int q = FIRST_SUM; q < SUMS; ++q) weights[SUM_OF(k, q) * points + p] = there ? w[q] : 0;
      }
    }
    BARRIER();
    fill_basis(order, some, points, position, factors, basis);
    BARRIER();
    for (int i = ITEM; i < TOGETHER * n; i += GROUP) {  // what is read of the basis serves all sums of a part
      const int k = i / n;
      const int b = i - k * n;
      lanes sum[EACH];
      UNROLL for (int q = 0; q < EACH; ++q) sum[q] = SPLAT(0);
      for (int p = 0; p < some; p += LANES) {
        const lanes of_point = LOAD(basis + b * PITCH(points) + p);
        UNROLL for (int q = 0; q < EACH; ++q) sum[q] = FMA(of_point, LOAD(weights + (k * EACH + q) * points + p), sum[q]);
      }
      UNROLL for (int q = 0; q < EACH; ++q) sums[(k * EACH + q) * n + b] += sum_of(sum[q]);
    }
  }
  BARRIER();
  GLOBAL real* multipole = multipoles + (size_t)leaf_nodes[leaf] * MULTIPOLES * (size_t)stride;
  for (int a = ITEM; a < stride; a += GROUP) {
    const int within = a < n;
    const Place place = place_of(within ? a : 0);
    for (int k = 0; k < TOGETHER; ++k) {
      const int part = first_part + k;
      const LOCAL real* of_part = sums + k * EACH * n;
      const LOCAL real* x = of_part + (EACH > 1 ? EACH - 3 : 0) * n;
      const real of_gradient = EACH > 1 && within ? -unit * along_gradient(x, x + n, x + 2 * n, place) : 0;
      const real value = FIRST_SUM == 0 && within ? of_part[a] : 0;
#if FORM == STOKES_WINDING
      if (part == 0) {
        multipole[a] = of_gradient;                                                              // W
        for (int c = 1; c < 4; ++c) multipole[(3 + c) * stride + a] = within ? of_part[c * n + a] : 0;  // P_c
        multipole[7 * stride + a] = value;                                                       // Q
      } else if (part < 4) {
        multipole[part * stride + a] = value + of_gradient;  // E_a
      } else {
        multipole[8 * stride + a] = of_gradient;  // W of width^2 eta
      }
#else
      multipole[part * stride + a] = value + of_gradient;
#endif
    }
  }
}

// Of FUSED expansions at one vector of points.
typedef struct {
  lanes value[FUSED], x[FUSED], y[FUSED], z[FUSED];
} Evaluated;
#define FUSED_VALUES (VALUES < FUSED ? VALUES : FUSED)
#define FUSED_GRADIENTS (GRADIENTS < FUSED ? GRADIENTS : FUSED)

// sum_a v_a B_a and sum_a g_a grad B_a. `values`: VALUES numbers for every a, of which the first FUSED are used; so `gradients`. The gradient
// is a sum of B_b of one degree less, by coefficients of their neighbours:
//   d/dx: c_{l+1}^{m-1} / 2 - c_{l+1}^{m+1} / 2    d/dy: the same, turned by i, with a sum    d/dz: c_{l+1}^m
// where that of order 0 counts twice.
FUNCTION void evaluate(const LOCAL real* values, const LOCAL real* gradients, const LOCAL real* factors, int order, lanes x, lanes y, lanes z,
                       Evaluated* e) {
  UNROLL for (int k = 0; k < FUSED; ++k) e->value[k] = e->x[k] = e->y[k] = e->z[k] = SPLAT(0);
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
    const real twice = m == 0 ? 0 : (m == 1 ? 2 : 1);
    const real once = m > 1 ? 1 : 0;
    lanes re = re_diagonal;
    lanes im = im_diagonal;
    lanes re_below = SPLAT(0);
    lanes im_below = SPLAT(0);
    for (int l = m; l <= order; ++l) {
      const LOCAL real* v = values + real_index(l, m) * VALUES;
      const LOCAL real* v_im = m > 0 ? v + VALUES : v;  // times 0 for m = 0
      UNROLL for (int k = 0; k < FUSED_VALUES; ++k) e->value[k] = FMA(SPLAT(v[k]), re, FMA(SPLAT(v_im[k]), im, e->value[k]));
      if (GRADIENTS > 0 && l < order) {
        const LOCAL real* same = gradients + real_index(l + 1, m) * GRADIENTS;
        const LOCAL real* same_im = m > 0 ? same + GRADIENTS : same;
        const LOCAL real* more = gradients + real_index(l + 1, m + 1) * GRADIENTS;
        const LOCAL real* more_im = more + GRADIENTS;
        const LOCAL real* less = gradients + real_index(l + 1, m > 0 ? m - 1 : 0) * GRADIENTS;
        const LOCAL real* less_im = m > 1 ? less + GRADIENTS : less;
        UNROLL for (int k = 0; k < FUSED_GRADIENTS; ++k) {
          e->x[k] = FMA(SPLAT(FMA(twice, less[k], -more[k])), re, FMA(SPLAT(FMA(once, less_im[k], -more_im[k])), im, e->x[k]));
          e->y[k] = FMA(SPLAT(-FMA(once, less_im[k], more_im[k])), re, FMA(SPLAT(FMA(twice, less[k], more[k])), im, e->y[k]));
          e->z[k] = FMA(SPLAT(same[k]), re, FMA(SPLAT(same_im[k]), im, e->z[k]));
        }
      }
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
  UNROLL for (int k = 0; k < FUSED_GRADIENTS; ++k) {
    e->x[k] *= SPLAT((real)0.5);
    e->y[k] *= SPLAT((real)0.5);
  }
}

// The expansions whose values and gradients make the sums. Those of S, docs/math.md, "The Stokes far field":
//   values 0: W of all pairs    1..3: E_a + P_a    4: W of the pairs that use E
//   gradients 0: Q - e^2 W (local widths: Q - half of the W of e^2 eta)    1..3: P_a    4, with local widths: W of all pairs
FUNCTION real value_coefficient(const GLOBAL real* local_, int stride, int k, int a) {
#if FORM == STOKES_WINDING
  if (k == 0) return local_[a] + local_[TRANSPOSED_WINDING * stride + a];
  if (k < 4) return local_[k * stride + a] + local_[(3 + k) * stride + a];
  return local_[a];
#else
  return local_[k * stride + a];
#endif
}
FUNCTION real gradient_coefficient(const GLOBAL real* local_, int stride, int k, real uniform_width2, int a) {
#if FORM == STOKES_WINDING
  const real all = local_[a] + local_[TRANSPOSED_WINDING * stride + a];
  if (k == 0) {
    return FMA(LOCAL_WIDTHS ? (real)-0.5 : -uniform_width2, LOCAL_WIDTHS ? local_[STOKES_LOCALS * stride * LOCAL_WIDTHS + a] : all,
               local_[7 * stride + a]);
  }
  return k < 4 ? local_[(3 + k) * stride + a] : all;
#else
  return local_[k * stride + a];
#endif
}

// Adds to channel c of the first `count` of a vector of targets.
FUNCTION void add_to(GLOBAL real* out, size_t at, int count, int c, lanes value) {
#if LANES == 1
  out[(at / BLOCK * CHANNELS + (size_t)c) * BLOCK + at % BLOCK] += value;
#else
  real one[LANES];
  STORE(value, one);
  for (int i = 0; i < LANES && i < count; ++i) {
    out[((at + (size_t)i) / BLOCK * CHANNELS + (size_t)c) * BLOCK + (at + (size_t)i) % BLOCK] += one[i];
  }
#endif
}

// Work-group g does target leaf first_leaf + g and adds to out: blocks x CHANNELS x BLOCK. Leaves, targets and their data as in near_field().
// Shared: n * (ROWS + 2) numbers.
#if FORM == STOKES_WINDING
#define ROWS (VALUES + GRADIENTS)
#else
#define ROWS (VALUES > 0 ? VALUES : GRADIENTS)  // values and gradients are of the same expansions
#endif
KERNEL locals_to_points(int first_leaf, const GLOBAL uint2* leaves, const GLOBAL uint* leaf_nodes, const GLOBAL int4* centres,
                        const GLOBAL real* targets_, const GLOBAL real* target_data, uint target_stride, int order, int stride,
                        real uniform_width2, const GLOBAL real* locals, GLOBAL real* out SHARED_ARGUMENT) {
  SHARED(shared);
  const int leaf = first_leaf + GROUP_INDEX;
  const int n = (order + 1) * (order + 1);
  LOCAL real* values = shared;  // for every a
  LOCAL real* gradients = FORM == STOKES_WINDING ? values + VALUES * n : values;
  LOCAL real* factors = shared + ROWS * n;  // 2 x n
  const int count = (int)leaves[leaf].y;
  const real unit = (real)(1 << centres[leaf].w);
  const GLOBAL real* local_ = locals + (size_t)leaf_nodes[leaf] * LOCALS * (size_t)stride;
  make_factors(order, factors);
  for (int a = ITEM; a < n; a += GROUP) {
    UNROLL for (int k = 0; k < VALUES; ++k) values[a * VALUES + k] = value_coefficient(local_, stride, k, a);
    UNROLL for (int k = 0; k < ROWS - VALUES; ++k) gradients[a * GRADIENTS + k] = gradient_coefficient(local_, stride, k, uniform_width2, a);
  }
  BARRIER();
  for (int target = ITEM * LANES; target < count; target += GROUP * LANES) {
    const int left = count - target;
    const size_t at = leaves[leaf].x + (uint)target;
    const lanes x = LOAD(targets_ + at);
    const lanes y = LOAD(targets_ + target_stride + at);
    const lanes z = LOAD(targets_ + 2 * (size_t)target_stride + at);
    lanes gx = SPLAT(0);
    lanes gy = SPLAT(0);
    lanes gz = SPLAT(0);
    for (int first = 0; first < (VALUES > GRADIENTS ? VALUES : GRADIENTS); first += FUSED) {
      Evaluated e;
      evaluate(values + first, gradients + first, factors, order, SPLAT(unit) * x, SPLAT(unit) * y, SPLAT(unit) * z, &e);
#if FORM == GREEN || FORM == GREEN_ADJOINT || FORM == WINDING
      UNROLL for (int k = 0; k < FUSED; ++k) add_to(out, at, left, first + k, SPLAT(unit) * e.value[k]);
#endif
#if FORM == GREEN_ADJOINT
      UNROLL for (int k = 0; k < FUSED; ++k) {
        const lanes u = LOAD(target_data + (size_t)(first + k) * target_stride + at);
        gx = FMA(u, e.x[k], gx);
        gy = FMA(u, e.y[k], gy);
        gz = FMA(u, e.z[k], gz);
      }
#elif FORM == WINDING_ADJOINT
      gx = e.x[0];
      gy = e.y[0];
      gz = e.z[0];
#elif FORM == WINDING_GRADIENT
      gx = -e.x[0];
      gy = -e.y[0];
      gz = -e.z[0];
#elif FORM == STOKES_WINDING
      gx = FMA(-x, e.x[1], FMA(-y, e.x[2], FMA(-z, e.x[3], e.x[0])));
      gy = FMA(-x, e.y[1], FMA(-y, e.y[2], FMA(-z, e.y[3], e.y[0])));
      gz = FMA(-x, e.z[1], FMA(-y, e.z[2], FMA(-z, e.z[3], e.z[0])));
#if LOCAL_WIDTHS
      const lanes half_width2 = SPLAT((real)-0.5) * LOAD(targets_ + 3 * (size_t)target_stride + at);
      gx = FMA(half_width2, e.x[4], gx);
      gy = FMA(half_width2, e.y[4], gy);
      gz = FMA(half_width2, e.z[4], gz);
#endif
      const lanes scale = SPLAT(unit);  // of a value; a gradient has it twice
      add_to(out, at, left, 0, scale * FMA(scale, gx, FMA(-x, e.value[4], e.value[1])));
      add_to(out, at, left, 1, scale * FMA(scale, gy, FMA(-y, e.value[4], e.value[2])));
      add_to(out, at, left, 2, scale * FMA(scale, gz, FMA(-z, e.value[4], e.value[3])));
      add_to(out, at, left, 3, scale * e.value[0]);
#endif
    }
#if FORM == GREEN_ADJOINT || FORM == WINDING_ADJOINT || FORM == WINDING_GRADIENT
    add_to(out, at, left, CHANNELS - 3, SPLAT(unit * unit) * gx);
    add_to(out, at, left, CHANNELS - 2, SPLAT(unit * unit) * gy);
    add_to(out, at, left, CHANNELS - 1, SPLAT(unit * unit) * gz);
#endif
  }
}

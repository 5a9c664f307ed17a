// The near field: exact pair sums, one work-group per target leaf. The counterpart of cpu/near_field.cpp; cpu/near_kernels.h explains the
// kernels.
//
// A tile of sources is gathered into local memory; items take a target each and, where a leaf has few, a share of the sources. Sums of a
// tile are floats; tiles are added up in pairs of floats, which are as good as the doubles of the processor.
//
// The program says: FORM, BATCH (K), LOCAL_WIDTHS, TILE, ROUGH, and the polynomials SINGLE_LAYER(w), DOUBLE_LAYER(w), STOKESLET(w), GRADIENT(w)
// in w = MAP_SCALE s / (s + MAP_POLE) - 1.
#define GEOMETRY (3 + LOCAL_WIDTHS)
#if FORM == GREEN
#define VALUES (3 + 2 * BATCH)
#define CHANNELS BATCH
#define TARGET_DATA 0
#elif FORM == GREEN_ADJOINT
#define VALUES BATCH
#define CHANNELS (BATCH + 3)
#define TARGET_DATA BATCH
#elif FORM == STOKES_WINDING
#define VALUES 3
#define CHANNELS 4
#define TARGET_DATA 0
#elif FORM == WINDING
#define VALUES 3
#define CHANNELS 1
#define TARGET_DATA 0
#elif FORM == WINDING_ADJOINT
#define VALUES 1
#define CHANNELS 3
#define TARGET_DATA 0
#else
#define VALUES 3
#define CHANNELS 3
#define TARGET_DATA 0
#endif
#define FIELDS (GEOMETRY + VALUES)
#define AWAY ((real)8)  // of what fills vectors up; points are within 4 of each other

#if LANES > 1 && !REAL_IS_DOUBLE
// Processors take far longer for a root and a quotient than for these steps of Newton's: after two of them 5e-6 are left, then rounding.
FUNCTION lanes inverse_root(lanes x) {
  lanes y = JOIN(as_float, LANES)(0x5f375a86 - (JOIN(as_int, LANES)(x) >> 1));
  const lanes half_x = SPLAT((real)0.5) * x;
  UNROLL for (int k = 0; k < (ROUGH ? 2 : 3); ++k) y *= FMA(-half_x * y, y, SPLAT((real)1.5));
  return y;
}
#else
#define inverse_root(x) RSQRT(x)
#endif

// Phi (Stokes: Phi + e^2 g), g, and h or b at one distance, without 1/(4 pi).
typedef struct {
  lanes value, flux, third;
} Kernels;

FUNCTION Kernels plain(lanes r2, lanes width2) {
  Kernels k;
  const lanes inverse = inverse_root(r2);
  const lanes inverse2 = inverse * inverse;
  k.value = inverse;
  k.flux = inverse * inverse2;
  k.third = k.flux;
#if FORM == STOKES_WINDING
  k.third = k.flux * FMA(SPLAT(-3) * width2, inverse2, SPLAT(1));
  k.value = FMA(width2, k.flux, inverse);
#elif FORM == WINDING_GRADIENT
  k.third = SPLAT(3) * k.flux * inverse2;
#endif
  return k;
}

FUNCTION Kernels mollified(lanes r2, lanes width2, lanes inverse_width) {
  Kernels k;
  const lanes inverse_width2 = inverse_width * inverse_width;
  const lanes s = r2 * inverse_width2;
  const lanes w = FMA(DIVIDE(s, s + SPLAT(MAP_POLE)), SPLAT(MAP_SCALE), SPLAT(-1));
  const lanes cube = inverse_width * inverse_width2;
  k.flux = cube * DOUBLE_LAYER(w);
  k.value = k.flux;
  k.third = k.flux;
#if FORM == GREEN || FORM == GREEN_ADJOINT || FORM == STOKES_WINDING
  k.value = inverse_width * SINGLE_LAYER(w);
#endif
#if FORM == STOKES_WINDING
  k.third = cube * STOKESLET(w);
  k.value = FMA(width2, k.flux, k.value);
#elif FORM == WINDING_GRADIENT
  k.third = cube * inverse_width2 * GRADIENT(w);
#endif
  return k;
}

FUNCTION Kernels kernels_at(lanes r2, lanes width2, lanes inverse_width, real reach2) {
  const lanes end = SPLAT(reach2) * width2;
#if LANES == 1
  if (r2 < end) {
#if LOCAL_WIDTHS
    inverse_width = inverse_root(width2);
#endif
    return mollified(r2, width2, inverse_width);
  }
  return plain(r2, width2);
#else
  Kernels k = plain(r2, width2);
  if (ANY_LESS(r2, end)) {
#if LOCAL_WIDTHS
    inverse_width = inverse_root(width2);
#endif
    const Kernels m = mollified(r2, width2, inverse_width);
    k.value = r2 < end ? m.value : k.value;
    k.flux = r2 < end ? m.flux : k.flux;
    k.third = r2 < end ? m.third : k.third;
  }
  return k;
#endif
}

// Adds what one vector of sources contributes; `v` points to their first value, values are TILE apart.
FUNCTION void add_sources(const LOCAL real* v, lanes dx, lanes dy, lanes dz, Kernels k, const real* u, lanes* sum) {
#if FORM == GREEN_ADJOINT
  lanes charge = SPLAT(0);
  UNROLL for (int c = 0; c < BATCH; ++c) {
    const lanes q = LOAD(v + c * TILE);
    charge = FMA(SPLAT(u[c]), q, charge);
    sum[c] = FMA(k.value, q, sum[c]);
  }
  const lanes flux = k.flux * charge;
  sum[BATCH] = FMA(flux, dx, sum[BATCH]);
  sum[BATCH + 1] = FMA(flux, dy, sum[BATCH + 1]);
  sum[BATCH + 2] = FMA(flux, dz, sum[BATCH + 2]);
#elif FORM == WINDING_ADJOINT
  const lanes flux = k.flux * LOAD(v);
  sum[0] = FMA(flux, dx, sum[0]);
  sum[1] = FMA(flux, dy, sum[1]);
  sum[2] = FMA(flux, dz, sum[2]);
#else
  const lanes ex = LOAD(v);
  const lanes ey = LOAD(v + TILE);
  const lanes ez = LOAD(v + 2 * TILE);
  const lanes dot_ = FMA(dx, ex, FMA(dy, ey, dz * ez));
#if FORM == GREEN
  const lanes flux = k.flux * dot_;
  UNROLL for (int c = 0; c < BATCH; ++c) {
    sum[c] = FMA(k.value, LOAD(v + (3 + 2 * c) * TILE), sum[c]);
    sum[c] = FMA(flux, LOAD(v + (4 + 2 * c) * TILE), sum[c]);
  }
#elif FORM == WINDING
  sum[0] = FMA(k.flux, dot_, sum[0]);
#else
  const lanes along = k.third * dot_;
#if FORM == STOKES_WINDING
  sum[0] = FMA(along, dx, FMA(k.value, ex, sum[0]));
  sum[1] = FMA(along, dy, FMA(k.value, ey, sum[1]));
  sum[2] = FMA(along, dz, FMA(k.value, ez, sum[2]));
  sum[3] = FMA(k.flux, dot_, sum[3]);
#else
  sum[0] = FMA(-along, dx, FMA(k.flux, ex, sum[0]));
  sum[1] = FMA(-along, dy, FMA(k.flux, ey, sum[1]));
  sum[2] = FMA(-along, dz, FMA(k.flux, ez, sum[2]));
#endif
#endif
#endif
}

// A target and what it has summed: high + low.
typedef struct {
  real x, y, z, width2;
  real u[TARGET_DATA + 1];
  real high[CHANNELS];
  real low[CHANNELS];
} Target;

// high + low += value, exactly but for the rounding of low (Knuth's sum of two).
FUNCTION void add_exactly(real* high, real* low, real value) {
  const real sum = *high + value;
  const real part = sum - *high;
  *low += (*high - (sum - part)) + (value - part);
  *high = sum;
}

// Adds the sources of a tile, vectors of LANES, from `first` on and `step` apart.
FUNCTION void add_tile(const LOCAL real* tile, int first, int step, int size, real uniform_width2, real inverse_width, real reach2,
                       Target* t) {
  lanes sum[CHANNELS];
  UNROLL for (int c = 0; c < CHANNELS; ++c) sum[c] = SPLAT(0);
  for (int s = first; s < size; s += step) {
    const lanes dx = LOAD(tile + s) - SPLAT(t->x);
    const lanes dy = LOAD(tile + TILE + s) - SPLAT(t->y);
    const lanes dz = LOAD(tile + 2 * TILE + s) - SPLAT(t->z);
    const lanes r2 = FMA(dx, dx, FMA(dy, dy, dz * dz));
#if LOCAL_WIDTHS
    const lanes width2 = FMA(SPLAT((real)0.5), LOAD(tile + 3 * TILE + s), SPLAT((real)0.5 * t->width2));
#else
    const lanes width2 = SPLAT(uniform_width2);
#endif
    const Kernels k = kernels_at(r2, width2, SPLAT(inverse_width), reach2);
    add_sources(tile + GEOMETRY * TILE + s, dx, dy, dz, k, t->u, sum);
  }
  UNROLL for (int c = 0; c < CHANNELS; ++c) add_exactly(t->high + c, t->low + c, sum_of(sum[c]));
}

// Work-group g does target leaf order[first + g]. Leaves: (first point, points). The near leaves of a target leaf and the points before
// each in all of them, modulo 2^32: near_leaves and near_points, from near_begin on. Geometry: x y z [squared width], each `stride` apart, as are the
// values of the sources, and the targets' by target_stride. out: blocks x CHANNELS x BLOCK, overwritten.
KERNEL near_field(int first, const GLOBAL uint* order, const GLOBAL uint* near_begin, const GLOBAL uint* near_leaves,
                  const GLOBAL uint* near_points, const GLOBAL uint2* target_leaves, const GLOBAL int4* target_centres,
                  const GLOBAL uint2* source_leaves, const GLOBAL int4* source_centres, const GLOBAL real* geometry,
                  const GLOBAL real* values, uint stride, const GLOBAL real* targets_, const GLOBAL real* target_data, uint target_stride,
                  real uniform_width2, real inverse_width, real reach2, GLOBAL real* out) {
  LOCAL_ARRAY(real, tile, FIELDS * TILE);
  LOCAL_ARRAY(real, parts, 2 * GROUP);
  const int leaf = (int)order[first + GROUP_INDEX];
  const int count = (int)target_leaves[leaf].y;
  const int4 centre = target_centres[leaf];
  const uint first_run = near_begin[leaf];
  const uint before = near_points[first_run];  // differences are exact: one leaf has fewer sources than 2^32
  const uint all = near_points[near_begin[leaf + 1]] - before;
  for (int begin = 0; begin < count; begin += GROUP) {
    const int targets = count - begin < GROUP ? count - begin : GROUP;
    const int shares = GROUP / targets < TILE / LANES ? GROUP / targets : TILE / LANES;
    const int item = ITEM;
    const int share = item / targets;
    const size_t at = target_leaves[leaf].x + (uint)(begin + item % targets);
    Target t;
    t.x = targets_[at];
    t.y = targets_[target_stride + at];
    t.z = targets_[2 * (size_t)target_stride + at];
    t.width2 = LOCAL_WIDTHS ? targets_[3 * (size_t)target_stride * LOCAL_WIDTHS + at] : 0;
    UNROLL for (int c = 0; c < TARGET_DATA; ++c) t.u[c] = target_data[(size_t)c * target_stride + at];
    UNROLL for (int c = 0; c < CHANNELS; ++c) t.high[c] = t.low[c] = 0;
    uint run = first_run;  // that holds the item's source
    for (uint done = 0; done < all; done += TILE) {
      const int size = all - done < TILE ? (int)(all - done) : TILE;
      const int padded = (size + LANES - 1) / LANES * LANES;
      BARRIER();
      for (int i = item * LANES; i < padded; i += GROUP * LANES) {  // LANES sources, run by run
        const int end = LANES == 1 || i + LANES < size ? i + LANES : size;
        int to = i;
        do {
          const uint source = done + (uint)to;
          while (near_points[run + 1] - before <= source) ++run;
          const uint left = near_points[run + 1] - before - source;  // of the run
          int from = to;
          to = LANES == 1 || left >= (uint)(end - from) ? end : from + (int)left;
          const uint source_leaf = near_leaves[run];
          const int4 source_centre = source_centres[source_leaf];
          const real x = (real)(source_centre.x - centre.x) * CELL;
          const real y = (real)(source_centre.y - centre.y) * CELL;
          const real z = (real)(source_centre.z - centre.z) * CELL;
          size_t p = source_leaves[source_leaf].x + (source - (near_points[run] - before));
          do {
            tile[from] = geometry[p] + x;
            tile[TILE + from] = geometry[stride + p] + y;
            tile[2 * TILE + from] = geometry[2 * (size_t)stride + p] + z;
            if (LOCAL_WIDTHS) tile[3 * TILE * LOCAL_WIDTHS + from] = geometry[3 * (size_t)stride * LOCAL_WIDTHS + p];
            UNROLL for (int f = 0; f < VALUES; ++f) tile[(GEOMETRY + f) * TILE + from] = values[(size_t)f * stride + p];
            ++p;
          } while (++from < to);
        } while (to < end);
        for (int pad = end; pad < i + LANES; ++pad) {  // far away, and without any value
          UNROLL for (int f = 0; f < FIELDS; ++f) tile[f * TILE + pad] = f < 3 ? AWAY : 0;
        }
      }
      BARRIER();
      if (share < shares) add_tile(tile, share * LANES, shares * LANES, padded, uniform_width2, inverse_width, reach2, &t);
    }
    UNROLL for (int c = 0; c < CHANNELS; ++c) {
      BARRIER();
      parts[item] = t.high[c];
      parts[GROUP + item] = t.low[c];
      BARRIER();
      if (item < targets) {
        real high = t.high[c];
        real low = t.low[c];
        for (int k = 1; k < shares; ++k) {
          add_exactly(&high, &low, parts[k * targets + item]);
          low += parts[GROUP + k * targets + item];
        }
        out[(at / BLOCK * CHANNELS + (size_t)c) * BLOCK + at % BLOCK] = high + low;
      }
    }
  }
}

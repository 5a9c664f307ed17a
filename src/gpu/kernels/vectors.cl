// The vectors of a solve: three doubles for every point, point after point. What is done with them between the sums, and what the sums take
// and give (blocks x channels x BLOCK, without 1/(4 pi)). The counterpart of solve/iterative_solver.cpp and of the
// products of solve/energy_system.cpp and solve/green_system.cpp.
//
// The program says: DOT_BLOCK, INV_4_PI. With `rooted` 0 every root is 1, and `roots` is not read.
#if !defined(__CUDACC__) && !defined(__HIPCC__)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#define INDEX ((uint)GROUP_INDEX * GROUP + (uint)ITEM)
#define SUM_AT(sums, i, channels, c) ((double)(sums)[((size_t)((i) / BLOCK) * (channels) + (c)) * BLOCK + (i) % BLOCK])

// y = scale y + factor x; y is not read where scale is 0.
KERNEL combine(uint points, double scale, double factor, const GLOBAL double* x, GLOBAL double* y) {
  const uint i = INDEX;
  if (i >= points) return;
  for (int a = 0; a < 3; ++a) {
    const size_t k = 3 * (size_t)i + (size_t)a;
    const double old = scale == 0 ? 0 : scale * y[k];
    y[k] = old + factor * x[k];
  }
}

// Work-group g adds a_k b_k over DOT_BLOCK doubles from DOT_BLOCK g on, in an order that depends on nothing else.
KERNEL dot_of_blocks(uint points, const GLOBAL double* a, const GLOBAL double* b, GLOBAL double* of_block) {
  LOCAL_ARRAY(double, sums, GROUP);
  const size_t count = 3 * (size_t)points;
  const size_t begin = (size_t)GROUP_INDEX * DOT_BLOCK;
  const size_t end = begin + DOT_BLOCK < count ? begin + DOT_BLOCK : count;
  double sum = 0;
  for (size_t k = begin + (size_t)ITEM; k < end; k += GROUP) sum += a[k] * b[k];
  sums[ITEM] = sum;
  BARRIER();
  for (int apart = GROUP / 2; apart > 0; apart /= 2) {
    if (ITEM < apart) sums[ITEM] += sums[ITEM + apart];
    BARRIER();
  }
  if (ITEM == 0) of_block[GROUP_INDEX] = sums[0];
}

// values: three fields of the sources, `stride` apart: root_i x_i, 0 past the last point.
KERNEL fill_vectors(uint points, uint stride, const GLOBAL double* x, const GLOBAL double* roots, int rooted, GLOBAL real* values) {
  const uint i = INDEX;
  if (i >= stride) return;
  const double root = rooted && i < points ? roots[i] : 1;
  for (int a = 0; a < 3; ++a) values[(size_t)a * stride + i] = i < points ? (real)(root * x[3 * (size_t)i + (size_t)a]) : (real)0;
}

// sums: S and W, four channels. product_i = S; values: root_i^2 W, 0 past the last point.
KERNEL take_stokes_winding(uint points, uint stride, const GLOBAL real* sums, const GLOBAL double* roots, int rooted, GLOBAL real* values,
                           GLOBAL double* product) {
  const uint i = INDEX;
  if (i >= stride) return;
  if (i >= points) {
    values[i] = 0;
    return;
  }
  for (int a = 0; a < 3; ++a) product[3 * (size_t)i + (size_t)a] = INV_4_PI * SUM_AT(sums, i, 4, a);
  const double root = rooted ? roots[i] : 1;
  values[i] = (real)(root * root * INV_4_PI * SUM_AT(sums, i, 4, 3));
}

// sums: W^T with the sign of the kernel, three channels. product_i = root_i (product_i + weight W^T) + damping x_i
KERNEL add_winding_adjoint(uint points, const GLOBAL real* sums, double weight, double damping, const GLOBAL double* roots, int rooted,
                           const GLOBAL double* x, GLOBAL double* product) {
  const uint i = INDEX;
  if (i >= points) return;
  const double root = rooted ? roots[i] : 1;
  for (int a = 0; a < 3; ++a) {
    const size_t k = 3 * (size_t)i + (size_t)a;
    product[k] = root * (product[k] - weight * INV_4_PI * SUM_AT(sums, i, 3, a)) + damping * x[k];
  }
}

// A batch of harmonics: u and its gradient are fields of N, the first of them of this batch; the last `batch` - `count` are 0.
// values: x, and of every harmonic grad u . x and u, 0 past the last point.
KERNEL fill_green(uint points, uint stride, const GLOBAL double* x, const GLOBAL real* u, const GLOBAL real* gradient, int first, int count,
                  int batch, GLOBAL real* values) {
  const uint i = INDEX;
  if (i >= stride) return;
  double v[3] = {0, 0, 0};
  for (int a = 0; a < 3 && i < points; ++a) v[a] = x[3 * (size_t)i + (size_t)a];
  for (int a = 0; a < 3; ++a) values[(size_t)a * stride + i] = (real)v[a];
  for (int k = 0; k < batch; ++k) {
    real monopole = 0;
    real dipole = 0;
    if (k < count && i < points) {
      const GLOBAL real* g = gradient + 3 * (size_t)(first + k) * points + i;
      monopole = (real)(g[0] * v[0] + g[points] * v[1] + g[2 * (size_t)points] * v[2]);
      dipole = u[(size_t)(first + k) * points + i];
    }
    values[(size_t)(3 + 2 * k) * stride + i] = monopole;
    values[(size_t)(4 + 2 * k) * stride + i] = dipole;
  }
}

// sums: A[u] x, `batch` channels. values: the same, and of_targets: u; 0 past the last point.
KERNEL take_green(uint points, uint stride, const GLOBAL real* sums, const GLOBAL real* u, int first, int count, int batch,
                  GLOBAL real* values, GLOBAL real* of_targets) {
  const uint i = INDEX;
  if (i >= stride) return;
  for (int k = 0; k < batch; ++k) {
    const int is_one = k < count && i < points;
    values[(size_t)k * stride + i] = is_one ? (real)(INV_4_PI * SUM_AT(sums, i, batch, k)) : (real)0;
    of_targets[(size_t)k * stride + i] = is_one ? u[(size_t)(first + k) * points + i] : (real)0;
  }
}

// sums: of the adjoint, with the sign of the kernel. product_i += A^T, or = for the first batch.
KERNEL add_green_adjoint(uint points, const GLOBAL real* sums, const GLOBAL real* gradient, int first, int count, int batch,
                         GLOBAL double* product) {
  const uint i = INDEX;
  if (i >= points) return;
  for (int a = 0; a < 3; ++a) {
    double sum = -SUM_AT(sums, i, batch + 3, batch + a);
    for (int k = 0; k < count; ++k) {
      sum += SUM_AT(sums, i, batch + 3, k) * (double)gradient[(3 * (size_t)(first + k) + (size_t)a) * points + i];
    }
    const size_t at = 3 * (size_t)i + (size_t)a;
    product[at] = (first == 0 ? 0 : product[at]) + INV_4_PI * sum;
  }
}

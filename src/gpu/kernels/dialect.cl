// What the kernels are written in: the part that OpenCL C 1.2 and CUDA C++ (and HIP) have in common, and names for the rest.
//
// The program says before this text: REAL_IS_DOUBLE (0 or 1), LANES (numbers worked on together: 1 on GPUs, a vector on processors) and
// GROUP (items of a work-group, which the launch must use).
#if defined(__CUDACC__) || defined(__HIPCC__)

typedef unsigned int uint;
#define KERNEL extern "C" __global__ void __launch_bounds__(GROUP)
#define FUNCTION static __device__ __forceinline__
#define GLOBAL
#define LOCAL
#define LOCAL_ARRAY(type, name, count) __shared__ type name[count]
#define SHARED_ARGUMENT
#define SHARED(name) extern __shared__ real name[]
#define BARRIER() __syncthreads()
#define ITEM ((int)threadIdx.x)
#define GROUP_INDEX ((int)blockIdx.x)
#if LANES != 1
#error "vectors of lanes are for processors"
#endif
#if REAL_IS_DOUBLE
typedef double real;
#define FMA(a, b, c) fma(a, b, c)
#define RSQRT(x) rsqrt(x)
#define DIVIDE(a, b) ((a) / (b))
#else
typedef float real;
#define FMA(a, b, c) fmaf(a, b, c)
#define RSQRT(x) rsqrtf(x)
#define DIVIDE(a, b) __fdividef(a, b)
#endif
struct __align__(16) real4 {
  real x, y, z, w;
};
#define LOAD4(from) (*(const real4*)(from))

#else

#if REAL_IS_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
typedef double4 real4;
#define DIVIDE(a, b) ((a) / (b))
#else
typedef float real;
typedef float4 real4;
#define DIVIDE(a, b) native_divide(a, b)
#endif
#define KERNEL __kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void
#define FUNCTION static inline __attribute__((always_inline))
#define GLOBAL __global
#define LOCAL __local
#define LOCAL_ARRAY(type, name, count) __local type name[count]
#define SHARED_ARGUMENT , __local real* shared_
#define SHARED(name) __local real* name = shared_
#define BARRIER() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#define ITEM ((int)get_local_id(0))
#define GROUP_INDEX ((int)get_group_id(0))
#define FMA(a, b, c) fma(a, b, c)
#define RSQRT(x) rsqrt(x)
#define LOAD4(from) vload4(0, from)

#endif

#define UNROLL _Pragma("unroll")
#define BLOCK 16        // targets, and rows of a matrix, are stored in blocks of this many
#define CELL ((real)4.76837158203125e-7)  // 2^-21: centres of nodes are multiples of it

#if LANES == 1
typedef real lanes;
#define SPLAT(x) (x)
#define LOAD(from) (*(from))
#define STORE(value, to) (*(to) = (value))
#define sum_of(v) (v)
#define ANY_LESS(a, b) ((a) < (b))
#else
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if REAL_IS_DOUBLE
typedef JOIN(double, LANES) lanes;
#define MASK long
#else
typedef JOIN(float, LANES) lanes;
#define MASK int
#endif
typedef JOIN(MASK, LANES) masks;
#define SPLAT(x) ((lanes)(x))
#define LOAD(from) JOIN(vload, LANES)(0, from)
#define STORE(value, to) JOIN(vstore, LANES)(value, 0, to)
#define ANY_LESS(a, b) is_any((a) < (b))
FUNCTION real sum_of(lanes v) {
#if LANES == 2
  return v.x + v.y;
#elif LANES == 4
  return (v.x + v.z) + (v.y + v.w);
#elif LANES == 8
  return ((v.s0 + v.s4) + (v.s2 + v.s6)) + ((v.s1 + v.s5) + (v.s3 + v.s7));
#else
  return (((v.s0 + v.s8) + (v.s4 + v.sc)) + ((v.s2 + v.sa) + (v.s6 + v.se))) +
         (((v.s1 + v.s9) + (v.s5 + v.sd)) + ((v.s3 + v.sb) + (v.s7 + v.sf)));
#endif
}
// Whether a comparison is true in any lane, by halves: any() goes lane by lane.
FUNCTION int is_any(masks m) {
#if LANES == 2
  return (m.x | m.y) != 0;
#elif LANES == 4
  return ((m.x | m.z) | (m.y | m.w)) != 0;
#else
#if LANES == 16
  const JOIN(MASK, 8) half_of = m.lo | m.hi;
#else
  const JOIN(MASK, 8) half_of = m;
#endif
  const JOIN(MASK, 4) fourth = half_of.lo | half_of.hi;
  const JOIN(MASK, 2) eighth = fourth.lo | fourth.hi;
  return (eighth.x | eighth.y) != 0;
#endif
}
#endif

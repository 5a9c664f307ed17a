// The K nearest points of every point of a k-d tree. The counterpart of cloud/neighbours.cpp, which explains the tree; distances have the
// same bytes, and those as far come by their index, so that the result is the same whatever the order of the search.
//
// The program says: K, LEAF (points of a leaf), MOST_DEPTH (of the tree).
#if defined(__CUDACC__) || defined(__HIPCC__)
#define ADD(a, b) __dadd_rn(a, b)
#define MULTIPLY(a, b) __dmul_rn(a, b)
#define NO_DISTANCE __longlong_as_double(0x7ff0000000000000LL)
#else
#pragma OPENCL FP_CONTRACT OFF
#define ADD(a, b) ((a) + (b))
#define MULTIPLY(a, b) ((a) * (b))
#define NO_DISTANCE ((double)INFINITY)
#endif
#define NO_POINT 0xFFFFFFFFu

// Leaves [begin, end), the first of their inner nodes, and how far they are from the point along every axis, squared.
typedef struct {
  uint begin, end, first;
  double off[3];
} Node;

FUNCTION double sum_of_squares(const double* d) { return ADD(ADD(d[0], d[1]), d[2]); }

// Item i does the i-th point in the order of the tree. points: x, y and z, `count` apart, in that order; order: their indices; cuts: before,
// after and axis of every inner node. out: a row for every point, by its index.
KERNEL nearest_of_all(uint count, uint leaves, const GLOBAL double* points, const GLOBAL uint* order,
                      const GLOBAL double* cuts, GLOBAL uint* out) {
  const uint item = (uint)GROUP_INDEX * GROUP + (uint)ITEM;
  if (item >= count) return;
  const double x[3] = {points[item], points[(size_t)count + item], points[2 * (size_t)count + item]};
  double squared[K];
  uint index[K];
  UNROLL for (int k = 0; k < K; ++k) {
    squared[k] = NO_DISTANCE;
    index[k] = NO_POINT;
  }
  Node waiting[MOST_DEPTH];
  int depth = 0;
  Node node;
  node.begin = 0;
  node.end = leaves;
  node.first = 0;
  node.off[0] = node.off[1] = node.off[2] = 0;
  for (;;) {
    while (node.end - node.begin > 1) {
      const GLOBAL double* cut = cuts + 3 * (size_t)node.first;
      const int axis = (int)cut[2];
      const double at = axis == 0 ? x[0] : axis == 1 ? x[1] : x[2];
      const double past = at - cut[0];
      const double short_of = cut[1] - at;
      const int is_before = past < short_of;
      const uint first_half = (node.end - node.begin) / 2;
      const double over = is_before ? short_of : past;
      const double d = over > 0 ? MULTIPLY(over, over) : 0;
      Node other = node;
      UNROLL for (int a = 0; a < 3; ++a) other.off[a] = a == axis && d > node.off[a] ? d : node.off[a];
      if (is_before) {
        other.begin = node.begin + first_half;
        other.first = node.first + first_half;
        node.end = other.begin;
        node.first += 1;
      } else {
        other.end = node.begin + first_half;
        other.first += 1;
        node.begin = other.end;
        node.first += first_half;
      }
      if (!(sum_of_squares(other.off) > squared[K - 1])) waiting[depth++] = other;
    }
    const uint end = (node.begin + 1) * LEAF < count ? (node.begin + 1) * LEAF : count;
    for (uint p = node.begin * LEAF; p < end; ++p) {
      const double away[3] = {points[p] - x[0], points[(size_t)count + p] - x[1], points[2 * (size_t)count + p] - x[2]};
      double distance = ADD(ADD(MULTIPLY(away[0], away[0]), MULTIPLY(away[1], away[1])), MULTIPLY(away[2], away[2]));
      if (distance > squared[K - 1]) continue;
      uint point = order[p];
      UNROLL for (int k = 0; k < K; ++k) {  // the farther of the two goes on
        const int before = distance < squared[k] || (distance == squared[k] && point < index[k]);
        const double farther = before ? squared[k] : distance;
        const uint farther_point = before ? index[k] : point;
        squared[k] = before ? distance : squared[k];
        index[k] = before ? point : index[k];
        distance = farther;
        point = farther_point;
      }
    }
    do {
      if (depth == 0) {
        UNROLL for (int k = 0; k < K; ++k) out[(size_t)order[item] * K + (size_t)k] = index[k];
        return;
      }
      node = waiting[--depth];
    } while (sum_of_squares(node.off) > squared[K - 1]);
  }
}

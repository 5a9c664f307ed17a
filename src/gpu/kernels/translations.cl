// Expansions through matrices: multipoles to parents, multipoles to locals, locals to children. The counterpart of cpu/translations.cpp.
//
// A matrix has its rows in groups of BLOCK, column after column; a group is (offset of its data in units of BLOCK, first column, last
// column, -). An item does LANES rows for all expansions of a node, so that an entry serves them all; expansions wait in local memory.
//
// The program says: FORM, BATCH (K), LOCAL_WIDTHS.
#if FORM == STOKES_WINDING
#define MULTIPOLES (8 + LOCAL_WIDTHS)
#define LOCALS (9 + LOCAL_WIDTHS)
#define MOST_MOVED (5 + LOCAL_WIDTHS)
#elif FORM == GREEN || FORM == GREEN_ADJOINT
#define MULTIPOLES BATCH
#define LOCALS BATCH
#define MOST_MOVED BATCH
#else
#define MULTIPOLES 1
#define LOCALS 1
#define MOST_MOVED 1
#endif
// Items that copy one expansion together.
#if LANES == 1
#define COPIERS 16
#else
#define COPIERS 1
#endif
#define POSITIVE 8  // flag of a pair, besides the mirror image in bits 0 to 2

// multipoles_to_locals(): an item does this many groups of rows, so that what it reads of an expansion serves them all, and asks for this
// many columns at a time. Processors have no registers to spare, and wait less.
#if LANES == 1
#define ROW_GROUPS 3
#define COLUMNS 4
#else
#define ROW_GROUPS 1
#define COLUMNS 1
#endif
// Where coefficient j of a pair's expansion c is in local memory, and from a pair to the next. On a GPU the expansions of a coefficient lie
// side by side, in fours, and neighbouring pairs in other banks; a processor copies expansions as vectors.
#define PACKED (MOST_MOVED == 1 ? 1 : (MOST_MOVED + 3) / 4 * 4)
#define SLOT(stride) ((stride) * PACKED + 8)
#if LANES == 1
#define PACKED_AT(c, j, stride) ((j) * PACKED + (c))
#else
#define PACKED_AT(c, j, stride) ((c) * (stride) + (j))
#endif

// sum[c] = rows of the matrix from `row` on times expansion c of `from`, `stride` apart. Columns from `most` on are left out.
FUNCTION void product(const GLOBAL real* matrices, const GLOBAL uint4* groups, int row, int most, const LOCAL real* from, int stride,
                      int expansions, lanes* sum) {
  const uint4 group = groups[row / BLOCK];
  const GLOBAL real* entries = matrices + (size_t)group.x * BLOCK + row % BLOCK;
  const int end = (int)group.z < most ? (int)group.z : most;
  UNROLL for (int c = 0; c < expansions; ++c) sum[c] = SPLAT(0);
  for (int j = (int)group.y; j < end; ++j, entries += BLOCK) {
    const lanes entry = LOAD(entries);
    UNROLL for (int c = 0; c < expansions; ++c) sum[c] = FMA(entry, SPLAT(from[c * stride + j]), sum[c]);
  }
}

// Moments of Stokeslets move with their centre: E_a += move_a W, Q += move . P.
FUNCTION void move_moments(int4 from, int4 to, lanes* sum) {
#if FORM == STOKES_WINDING
  const real x = (real)(from.x - to.x) * CELL;
  const real y = (real)(from.y - to.y) * CELL;
  const real z = (real)(from.z - to.z) * CELL;
  sum[1] = FMA(SPLAT(x), sum[0], sum[1]);
  sum[2] = FMA(SPLAT(y), sum[0], sum[2]);
  sum[3] = FMA(SPLAT(z), sum[0], sum[3]);
  sum[7] = FMA(SPLAT(x), sum[4], FMA(SPLAT(y), sum[5], FMA(SPLAT(z), sum[6], sum[7])));
#endif
}

// Work-group g does node first_node + g: the sum of its children's multipoles, in their order; leaves have theirs. Children: (first,
// number). Octant o has groups [o * groups_apart, ...). Shared: MULTIPOLES * stride numbers.
KERNEL multipoles_to_parents(int first_node, const GLOBAL uint2* children, const GLOBAL uint* octants, const GLOBAL int4* centres,
                             const GLOBAL real* matrices, const GLOBAL uint4* groups, int groups_apart, int most, int stride,
                             GLOBAL real* multipoles SHARED_ARGUMENT) {
  SHARED(from);
  const int node = first_node + GROUP_INDEX;
  const int first = (int)children[node].x;
  const int end = first + (int)children[node].y;
  GLOBAL real* to = multipoles + (size_t)node * MULTIPOLES * (size_t)stride;
  for (int child = first; child < end; ++child) {
    BARRIER();
    const GLOBAL real* multipole = multipoles + (size_t)child * MULTIPOLES * (size_t)stride;
    for (int i = ITEM; i < MULTIPOLES * stride; i += GROUP) from[i] = multipole[i];
    BARRIER();
    for (int row = ITEM * LANES; row < stride; row += GROUP * LANES) {
      lanes sum[MULTIPOLES];
      product(matrices, groups + octants[child] * (uint)groups_apart, row, most, from, stride, MULTIPOLES, sum);
      move_moments(centres[child], centres[node], sum);
      UNROLL for (int c = 0; c < MULTIPOLES; ++c) {
        STORE(child == first ? sum[c] : LOAD(to + c * stride + row) + sum[c], to + c * stride + row);
      }
    }
  }
}

// Work-group g adds to the locals of node first_node + g those of its parent. Shared: LOCALS * stride numbers.
KERNEL locals_to_children(int first_node, const GLOBAL uint* parents, const GLOBAL uint* octants, const GLOBAL int4* centres,
                          const GLOBAL real* matrices, const GLOBAL uint4* groups, int groups_apart, int most, int stride,
                          GLOBAL real* locals SHARED_ARGUMENT) {
  SHARED(from);
  const int node = first_node + GROUP_INDEX;
  const GLOBAL real* local_ = locals + (size_t)parents[node] * LOCALS * (size_t)stride;
  GLOBAL real* to = locals + (size_t)node * LOCALS * (size_t)stride;
  for (int i = ITEM; i < LOCALS * stride; i += GROUP) from[i] = local_[i];
  BARRIER();
  for (int row = ITEM * LANES; row < stride; row += GROUP * LANES) {
    lanes sum[LOCALS];
    product(matrices, groups + octants[node] * (uint)groups_apart, row, most, from, stride, LOCALS, sum);
    move_moments(centres[parents[node]], centres[node], sum);
    UNROLL for (int c = 0; c < LOCALS; ++c) STORE(LOAD(to + c * stride + row) + sum[c], to + c * stride + row);
  }
}

// Where the expansions of a pair come from and go to. S is had from W and E or, transposed, from W, P and Q.
FUNCTION int source_expansion(int c, int moved, int transposed) {
#if FORM == STOKES_WINDING
  if (LOCAL_WIDTHS && c == moved - 1) return MULTIPOLES - 1;
  return transposed && c > 0 ? c + 3 : c;
#else
  return c;
#endif
}
FUNCTION int target_expansion(int c, int moved, int transposed) {
#if FORM == STOKES_WINDING
  if (LOCAL_WIDTHS && c == moved - 1) return LOCALS - 1;
  if (c == 0) return transposed ? 8 : 0;
  return transposed ? c + 3 : c;
#else
  return c;
#endif
}

// Coefficient j of all expansions, before VALUE_OF(c) is one of them; a processor has each from where it is.
#if LANES == 1
FUNCTION void load_packed(const LOCAL real* from, int j, int stride, int moved, real* value) {
#if MOST_MOVED == 1
  value[0] = from[j];
#else
  UNROLL for (int c = 0; c < PACKED; c += 4) {
    if (c < moved) {
      const real4 four = LOAD4(from + PACKED_AT(c, j, stride));
      value[c] = four.x;
      value[c + 1] = four.y;
      value[c + 2] = four.z;
      value[c + 3] = four.w;
    }
  }
#endif
}
#define VALUE_OF(c) value[c]
#else
#define load_packed(from, j, stride, moved, value)
#define VALUE_OF(c) from[PACKED_AT(c, j + k, stride)]
#endif

// locals of the target += D K D multipoles of the source, D the signs of the pair's mirror image, for LANES rows at `lane` of the groups of
// rows [first_group, first_group + ROW_GROUPS), of which there are `row_groups`.
FUNCTION void add_pair(const GLOBAL real* matrices, const GLOBAL uint4* groups, int row_groups, int first_group, int lane, int most,
                       const LOCAL real* from, int stride, int moved, int transposed, uint4 pair, const GLOBAL int4* source_centres,
                       const GLOBAL int4* target_centres, const GLOBAL real* signs, GLOBAL real* locals) {
  lanes sum[ROW_GROUPS][MOST_MOVED];
  int first[ROW_GROUPS];
  int end[ROW_GROUPS];
  int at_zero[ROW_GROUPS];  // where column 0 would be, in blocks
  int from_column = most;
  int to_column = 0;
  UNROLL for (int g = 0; g < ROW_GROUPS; ++g) {
    const int within = first_group + g < row_groups;
    const uint4 group = groups[within ? first_group + g : first_group];
    first[g] = within ? (int)group.y : most;
    end[g] = within ? ((int)group.z < most ? (int)group.z : most) : 0;
    at_zero[g] = (int)group.x - (int)group.y;
    from_column = first[g] < from_column ? first[g] : from_column;
    to_column = end[g] > to_column ? end[g] : to_column;
    UNROLL for (int c = 0; c < moved; ++c) sum[g][c] = SPLAT(0);
  }
  for (int j = from_column; j < to_column; j += COLUMNS) {
    lanes entry[ROW_GROUPS][COLUMNS];  // asked for together, so that the way to memory is waited for once
    UNROLL for (int g = 0; g < ROW_GROUPS; ++g) {
      UNROLL for (int k = 0; k < COLUMNS; ++k) {
        entry[g][k] = j + k >= first[g] && j + k < end[g] ? LOAD(matrices + (size_t)(at_zero[g] + j + k) * BLOCK + lane) : SPLAT(0);
      }
    }
    UNROLL for (int k = 0; k < COLUMNS; ++k) {
      real value[PACKED];
      load_packed(from, j + k, stride, moved, value);
      UNROLL for (int g = 0; g < ROW_GROUPS; ++g) {
        UNROLL for (int c = 0; c < moved; ++c) sum[g][c] = FMA(entry[g][k], SPLAT(VALUE_OF(c)), sum[g][c]);
      }
    }
  }
#if FORM == STOKES_WINDING
  const int4 source = source_centres[pair.y];
  const int4 target = target_centres[pair.x];
  const real x = (real)(source.x - target.x) * CELL;
  const real y = (real)(source.y - target.y) * CELL;
  const real z = (real)(source.z - target.z) * CELL;
#endif
  UNROLL for (int g = 0; g < ROW_GROUPS; ++g) {
    if (first_group + g >= row_groups) continue;
#if FORM == STOKES_WINDING
    if (transposed) {
      sum[g][4] = FMA(SPLAT(x), sum[g][1], FMA(SPLAT(y), sum[g][2], FMA(SPLAT(z), sum[g][3], sum[g][4])));
    } else {
      sum[g][1] = FMA(SPLAT(x), sum[g][0], sum[g][1]);
      sum[g][2] = FMA(SPLAT(y), sum[g][0], sum[g][2]);
      sum[g][3] = FMA(SPLAT(z), sum[g][0], sum[g][3]);
    }
#endif
    const int row = (first_group + g) * BLOCK + lane;
    const lanes sign = LOAD(signs + (int)(pair.z & 7) * stride + row);
    GLOBAL real* to = locals + (size_t)pair.x * LOCALS * (size_t)stride + row;
    UNROLL for (int c = 0; c < moved; ++c) {
      GLOBAL real* at = to + target_expansion(c, moved, transposed) * stride;
      STORE(FMA(sign, sum[g][c], LOAD(at)), at);
    }
  }
}

// Work-group g does the target nodes [chunk_nodes * chunk, ...) of chunk = first_chunk + g: tiles of pairs (target, source, flags, -) that
// share a matrix and have different targets, so that no two items add to one place. Tiles: (matrix, first pair, pairs, POSITIVE or 0).
// Matrices: (first group of rows, groups, columns, -). Shared: slots * SLOT(stride) numbers.
KERNEL multipoles_to_locals(int first_chunk, int chunk_nodes, int nodes, const GLOBAL uint* chunk_tiles, const GLOBAL uint4* tiles,
                            const GLOBAL uint4* pairs, const GLOBAL int4* source_centres, const GLOBAL int4* target_centres,
                            const GLOBAL real* signs, const GLOBAL real* matrices, const GLOBAL uint4* groups,
                            const GLOBAL uint4* shapes, int stride, int slots, const GLOBAL real* multipoles,
                            GLOBAL real* locals SHARED_ARGUMENT) {
  SHARED(packed);
  const int chunk = first_chunk + GROUP_INDEX;
  const int first_node = chunk * chunk_nodes;
  const int end_node = first_node + chunk_nodes < nodes ? first_node + chunk_nodes : nodes;
  const size_t begin = (size_t)first_node * LOCALS * (size_t)stride;
  const size_t end = (size_t)end_node * LOCALS * (size_t)stride;
  for (size_t i = begin + (size_t)ITEM; i < end; i += GROUP) locals[i] = 0;
  const uint first_tile = chunk_tiles[chunk];
  const uint end_tile = chunk_tiles[chunk + 1];
  if (first_tile == end_tile) return;
  uint4 t = tiles[first_tile];
  uint4 shape = shapes[t.x];
  for (uint tile = first_tile; tile < end_tile; ++tile) {
    const uint4 next_t = tiles[tile + 1 < end_tile ? tile + 1 : tile];  // on its way while this one is worked on
    const uint4 next_shape = shapes[next_t.x];
    const GLOBAL uint4* group = groups + shape.x;
    const int row_groups = (int)shape.y;
    const int of_pair = (row_groups + ROW_GROUPS - 1) / ROW_GROUPS * (BLOCK / LANES);  // items
    const int most = (int)shape.z;
    const int copied = (most + COLUMNS - 1) / COLUMNS * COLUMNS;
    const int transposed = FORM == STOKES_WINDING && t.w == 0;
    const int moved = FORM == STOKES_WINDING ? 4 + transposed + LOCAL_WIDTHS : MOST_MOVED;
    for (int first = 0; first < (int)t.z; first += slots) {
      const int some = (int)t.z - first < slots ? (int)t.z - first : slots;
      BARRIER();
      for (int e = ITEM / COPIERS; e < some * moved; e += GROUP / COPIERS) {
        const int slot = e / moved;
        const int c = e - slot * moved;
        const uint4 pair = pairs[t.y + (uint)(first + slot)];
        const size_t expansion = (size_t)pair.y * MULTIPOLES + (size_t)source_expansion(c, moved, transposed);
        const GLOBAL real* sign = signs + (int)(pair.z & 7) * stride;
        for (int j = ITEM % COPIERS * LANES; j < copied; j += COPIERS * LANES) {
          const lanes value = LOAD(sign + j) * LOAD(multipoles + expansion * (size_t)stride + j);
          STORE(value, packed + slot * SLOT(stride) + PACKED_AT(c, j, stride));
        }
      }
      BARRIER();
      for (int i = ITEM; i < some * of_pair; i += GROUP) {
        const int slot = i / of_pair;
        const int group_of_item = (i - slot * of_pair) / (BLOCK / LANES) * ROW_GROUPS;
        const int lane = i % (BLOCK / LANES) * LANES;
        const LOCAL real* from = packed + slot * SLOT(stride);
        const uint4 pair = pairs[t.y + (uint)(first + slot)];
#if FORM == STOKES_WINDING
        if (transposed) {
          add_pair(matrices, group, row_groups, group_of_item, lane, most, from, stride, 5 + LOCAL_WIDTHS, 1, pair, source_centres,
                   target_centres, signs, locals);
        } else {
          add_pair(matrices, group, row_groups, group_of_item, lane, most, from, stride, 4 + LOCAL_WIDTHS, 0, pair, source_centres,
                   target_centres, signs, locals);
        }
#else
        add_pair(matrices, group, row_groups, group_of_item, lane, most, from, stride, MOST_MOVED, 0, pair, source_centres, target_centres,
                 signs, locals);
#endif
      }
    }
    t = next_t;
    shape = next_shape;
  }
}

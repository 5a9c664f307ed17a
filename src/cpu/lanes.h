// Vectors of at most kLanes numbers, for sources that Highway compiles once per instruction set: to be included after
// <hwy/foreach_target.h>.
#if defined(G3R_CPU_LANES_H) == defined(HWY_TARGET_TOGGLE)  // once for every instruction set
#ifdef G3R_CPU_LANES_H
#undef G3R_CPU_LANES_H
#else
#define G3R_CPU_LANES_H
#endif

#include "cpu/near_field.h"

#include <hwy/highway.h>

#include "cpu/wasm_doubles.h"  // NOLINT(llvm-include-order): adds to what stands above

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::CappedTag<T, kLanes>;
template <class T>
using Vec = hn::Vec<Tag<T>>;

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

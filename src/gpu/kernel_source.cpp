#include "gpu/kernel_source.h"

#include "kernels/kernel_polynomials.h"
#include "kernels/kernels.h"

#include <ios>
#include <locale>
#include <sstream>
#include <string_view>

namespace g3r::gpu {
namespace kernels {  // made by g3r_embed_text()
extern const std::string_view dialect_cl;
extern const std::string_view near_field_cl;
extern const std::string_view expansions_cl;
extern const std::string_view translations_cl;
extern const std::string_view vectors_cl;
extern const std::string_view neighbours_cl;
}  // namespace kernels

namespace {

// GPUs: two full leaves of targets, or one and its sources in shares; large enough to hide the way to memory, small enough for many groups.
constexpr std::size_t kNearGroup = 128;
constexpr std::size_t kFarGroup = 32;
constexpr std::size_t kVectorsGroup = 128;
constexpr std::size_t kNeighboursGroup = 64;  // items of a group wait for the one that takes longest
constexpr std::size_t kMostDepth = 32;        // of a tree of fewer than 2^32 points
constexpr std::size_t kSoftwareGroup = 16;
constexpr std::size_t kSoftwareNearGroup = 64;  // a leaf of targets
constexpr std::size_t kTile = 128;              // sources of the near field in local memory at a time: one per item

std::string define(const char* name, std::size_t value) { return std::string("#define ") + name + ' ' + std::to_string(value) + '\n'; }

template <class T>
std::string literal(T value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(sizeof(T) == 4 ? 9 : 17);
  text << std::scientific << static_cast<double>(value) << (sizeof(T) == 4 ? "f" : "");
  return text.str();
}

// #define NAME(w) a polynomial by Horner's rule.
template <class T, std::size_t kTerms>
std::string polynomial(const char* name, const T (&coefficients)[kTerms]) {
  std::string text = "SPLAT(" + literal(coefficients[kTerms - 1]) + ")";
  for (std::size_t k = kTerms - 1; k-- > 0;) text = "FMA(" + text + ", (w), SPLAT(" + literal(coefficients[k]) + "))";
  return std::string("#define ") + name + "(w) " + text + '\n';
}

template <class T, Precision kPrecision>
std::string polynomials() {
  using P = Polynomials<T, kPrecision>;
  return polynomial("SINGLE_LAYER", P::kSingleLayer) + polynomial("DOUBLE_LAYER", P::kDoubleLayer) +
         polynomial("STOKESLET", P::kStokeslet) + polynomial("GRADIENT", P::kGradient) + "#define MAP_SCALE " +
         literal(static_cast<T>(kMapScale<T>)) + "\n#define MAP_POLE " + literal(static_cast<T>(kMapPole)) + '\n';
}

// The names of the forms, and which of them this is.
std::string forms(const KernelTraits& traits) {
  using cpu::NearForm;
  std::string text;
  for (const auto& [name, form] :
       {std::pair{"GREEN", NearForm::kGreen}, std::pair{"GREEN_ADJOINT", NearForm::kGreenAdjoint},
        std::pair{"STOKES_WINDING", NearForm::kStokesWinding}, std::pair{"WINDING", NearForm::kWinding},
        std::pair{"WINDING_ADJOINT", NearForm::kWindingAdjoint}, std::pair{"WINDING_GRADIENT", NearForm::kWindingGradient}}) {
    text += define(name, static_cast<std::size_t>(form));
  }
  return text + define("FORM", static_cast<std::size_t>(traits.form)) + define("BATCH", static_cast<std::size_t>(traits.batch)) +
         define("LOCAL_WIDTHS", traits.local_widths ? 1 : 0);
}

// TILE: processors rather have few turns, within their cache, as the loops of src/cpu.
std::size_t near_tile(const KernelTraits& traits) {
  using enum cpu::NearForm;
  if (traits.lanes == 1) return kTile;
  const auto batch = static_cast<std::size_t>(traits.batch);
  const std::size_t values = traits.form == kGreen            ? 3 + 2 * batch
                             : traits.form == kGreenAdjoint   ? batch
                             : traits.form == kWindingAdjoint ? 1
                                                              : 3;
  return cpu::gathered_sources((traits.local_widths ? 4 : 3) + values);
}

std::string source(const KernelTraits& traits, std::size_t group, const std::string& more, std::string_view text) {
  return define("REAL_IS_DOUBLE", traits.doubles ? 1 : 0) + define("LANES", traits.lanes) + define("GROUP", group) + forms(traits) +
         std::string(kernels::dialect_cl) + more + std::string(text);
}

}  // namespace

std::size_t near_group(const KernelTraits& traits) { return traits.lanes > 1 ? kSoftwareNearGroup : kNearGroup; }
std::size_t far_group(const KernelTraits& traits) { return traits.lanes > 1 ? kSoftwareGroup : kFarGroup; }

std::string near_field_source(const KernelTraits& traits) {
  const std::string fitted = traits.doubles ? polynomials<double, Precision::kFull>()
                             : traits.rough ? polynomials<float, Precision::kRough>()
                                            : polynomials<float, Precision::kFull>();
  const std::string more = define("TILE", near_tile(traits)) + define("ROUGH", traits.rough ? 1 : 0);
  return source(traits, near_group(traits), fitted + more, kernels::near_field_cl);
}

std::string expansions_source(const KernelTraits& traits) { return source(traits, far_group(traits), {}, kernels::expansions_cl); }

std::string translations_source(const KernelTraits& traits) { return source(traits, far_group(traits), {}, kernels::translations_cl); }

std::string vectors_source(bool doubles, bool software) {
  return define("REAL_IS_DOUBLE", doubles ? 1 : 0) + define("LANES", 1) + define("GROUP", vectors_group(software)) +
         std::string(kernels::dialect_cl) + define("DOT_BLOCK", kDotBlock) + "#define INV_4_PI " + literal(kInv4Pi) + '\n' +
         std::string(kernels::vectors_cl);
}

std::size_t vectors_group(bool software) { return software ? kSoftwareGroup : kVectorsGroup; }

std::string neighbours_source(std::size_t k, std::size_t leaf, bool software) {
  return define("REAL_IS_DOUBLE", 1) + define("LANES", 1) + define("GROUP", neighbours_group(software)) + std::string(kernels::dialect_cl) +
         define("K", k) + define("LEAF", leaf) + define("MOST_DEPTH", kMostDepth) + std::string(kernels::neighbours_cl);
}

std::size_t neighbours_group(bool software) { return software ? kSoftwareGroup : kNeighboursGroup; }

}  // namespace g3r::gpu

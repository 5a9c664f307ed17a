// The vectors of a solve on a device: its sums run there, and nothing but the values of dot products comes back from one product to the
// next. Internal to src/sum.
#pragma once

#include "sum/harmonic_values.h"
#include "sum/solve_vectors.h"
#include "sum/sum_engine.h"

#include <memory>
#include <vector>

namespace g3r {

/// M = D (S_e + l W^T D^2 W) D + d I with D = diag(roots), of solve/energy_system.h.
struct EnergyTerms {
  double damping = 0;                ///< d
  double winding_weight = 0;         ///< l
  const std::vector<double>& roots;  ///< N, or empty for ones
};

/// Null where sums run on the processor, and on a device without doubles or without room for the vectors (100 bytes a point). `engine` must
/// outlive them; its `points` sources are its targets. The device goes on being used for sums when they are lost.
template <class T>
[[nodiscard]] std::unique_ptr<SolveVectors> energy_vectors(SumEngine<T>& engine, std::size_t points, const EnergyTerms& terms);
/// The same of M = sum_k A[u_k]^T A[u_k], of solve/green_system.h: 96 bytes a point and 4 K numbers of T.
template <class T>
[[nodiscard]] std::unique_ptr<SolveVectors> green_vectors(SumEngine<T>& engine, std::size_t points, const HarmonicValues& u);

extern template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<float>&, std::size_t, const EnergyTerms&);
extern template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<double>&, std::size_t, const EnergyTerms&);
extern template std::unique_ptr<SolveVectors> green_vectors(SumEngine<float>&, std::size_t, const HarmonicValues&);
extern template std::unique_ptr<SolveVectors> green_vectors(SumEngine<double>&, std::size_t, const HarmonicValues&);

}  // namespace g3r

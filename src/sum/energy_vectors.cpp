#include "sum/energy_vectors.h"

#include "gpu/execution.h"
#include "gpu/vectors_on_device.h"

#include <chrono>
#include <mutex>
#include <utility>

namespace g3r {
namespace {

std::size_t number(SolveVector vector) { return static_cast<std::size_t>(vector); }

template <class T>
class EnergyVectors : public SolveVectors {
 public:
  EnergyVectors(SumEngine<T>& engine, std::shared_ptr<gpu::Execution> execution, std::size_t points, const EnergyTerms& terms)
      : engine_(engine),
        execution_(std::move(execution)),
        damping_(terms.damping),
        winding_weight_(terms.winding_weight),
        vectors_(execution_->device(), points, kSolveVectors, terms.roots) {}

  void set(SolveVector to, const std::vector<Vec3>& values) override {
    on_device([&] { vectors_.write(number(to), values); });
  }
  std::vector<Vec3> take(SolveVector from) override {
    std::vector<Vec3> values;
    on_device([&] { values = vectors_.read(number(from)); });
    return values;
  }
  void copy(SolveVector from, SolveVector to) override {
    on_device([&] { vectors_.combine(number(to), 0, 1, number(from)); });
  }
  double dot(SolveVector a, SolveVector b) override {
    double value = 0;
    on_device([&] { value = vectors_.dot(number(a), number(b)); });
    return value;
  }
  void combine(SolveVector y, double scale, double factor, SolveVector x) override {
    on_device([&] { vectors_.combine(number(y), scale, factor, number(x)); });
  }
  void multiply(SolveVector x, SolveVector product) override {
    on_device([&] {
      const gpu::Buffer& stokes_winding =
          engine_.run_there(cpu::NearForm::kStokesWinding, 3, 4,
                            [&](const gpu::Buffer& values, std::size_t stride) { vectors_.fill_vectors(number(x), stride, values); });
      const gpu::Buffer& adjoint =
          engine_.run_there(cpu::NearForm::kWindingAdjoint, 1, 3, [&](const gpu::Buffer& values, std::size_t stride) {
            vectors_.take_stokes_winding(stokes_winding, number(product), stride, values);
          });
      vectors_.add_winding_adjoint(adjoint, winding_weight_, damping_, number(x), number(product));
    });
  }

 private:
  template <class Work>
  void on_device(const Work& work) {
    try {
      const std::unique_lock lock = execution_->device().lock();
      const auto start = std::chrono::steady_clock::now();
      work();
      execution_->add_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    } catch (const gpu::DeviceError& error) {
      throw VectorsLost(error.what());
    }
  }

  SumEngine<T>& engine_;
  std::shared_ptr<gpu::Execution> execution_;
  double damping_;
  double winding_weight_;
  gpu::VectorsOnDevice<T> vectors_;
};

}  // namespace

template <class T>
std::unique_ptr<SolveVectors> energy_vectors(SumEngine<T>& engine, std::size_t points, const EnergyTerms& terms) {
  std::shared_ptr<gpu::Execution> execution = engine.execution();
  if (!execution || !execution->usable(true)) return nullptr;
  try {
    const std::unique_lock lock = execution->device().lock();
    return std::make_unique<EnergyVectors<T>>(engine, execution, points, terms);
  } catch (const gpu::DeviceError&) {
    return nullptr;
  }
}

template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<float>&, std::size_t, const EnergyTerms&);
template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<double>&, std::size_t, const EnergyTerms&);

}  // namespace g3r

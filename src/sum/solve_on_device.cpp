#include "sum/solve_on_device.h"

#include "gpu/execution.h"
#include "gpu/vectors_on_device.h"
#include "sum/sum_operators.h"

#include <chrono>
#include <utility>

namespace g3r {
namespace {

std::size_t number(SolveVector vector) { return static_cast<std::size_t>(vector); }

// All but the product.
template <class T>
class VectorsThere : public SolveVectors {
 public:
  VectorsThere(SumEngine<T>& engine, std::shared_ptr<gpu::Execution> execution, std::size_t points, const std::vector<double>& roots)
      : engine_(engine), execution_(std::move(execution)), vectors_(execution_->device(), points, kSolveVectors, roots) {}

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
    on_device([&] { multiply_there(number(x), number(product)); });
  }

 protected:
  virtual void multiply_there(std::size_t x, std::size_t product) = 0;

  SumEngine<T>& engine_;
  std::shared_ptr<gpu::Execution> execution_;
  gpu::VectorsOnDevice<T> vectors_;

 private:
  template <class Work>
  void on_device(const Work& work) {
    try {
      execution_->device().alone([&] {
        const auto start = std::chrono::steady_clock::now();
        work();
        execution_->add_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      });
    } catch (const gpu::DeviceError& error) {
      throw VectorsLost(error.what());
    }
  }
};

template <class T>
class EnergyVectors : public VectorsThere<T> {
 public:
  EnergyVectors(SumEngine<T>& engine, std::shared_ptr<gpu::Execution> execution, std::size_t points, const EnergyTerms& terms)
      : VectorsThere<T>(engine, std::move(execution), points, terms.roots), damping_(terms.damping), weight_(terms.winding_weight) {}

 protected:
  void multiply_there(std::size_t x, std::size_t product) override {
    SumEngine<T>& engine = this->engine_;
    gpu::VectorsOnDevice<T>& vectors = this->vectors_;
    const std::size_t stride = engine.source_stride();
    const gpu::Buffer& stokes_winding =
        engine.run_there(cpu::NearForm::kStokesWinding, 1, 3, 4,
                         [&](const gpu::Buffer& values, const gpu::Buffer&) { vectors.fill_vectors(x, stride, values); });
    const gpu::Buffer& adjoint = engine.run_there(
        cpu::NearForm::kWindingAdjoint, 1, 1, 3,
        [&](const gpu::Buffer& values, const gpu::Buffer&) { vectors.take_stokes_winding(stokes_winding, product, stride, values); });
    vectors.add_winding_adjoint(adjoint, weight_, damping_, x, product);
  }

 private:
  double damping_;
  double weight_;
};

template <class T>
class GreenVectors : public VectorsThere<T> {
 public:
  GreenVectors(SumEngine<T>& engine, std::shared_ptr<gpu::Execution> execution, std::size_t points, const HarmonicValues& u)
      : VectorsThere<T>(engine, std::move(execution), points, {}), harmonics_(u.count) {
    this->vectors_.set_harmonics(u.count, u.value, u.gradient);
  }

 protected:
  void multiply_there(std::size_t x, std::size_t product) override {
    SumEngine<T>& engine = this->engine_;
    gpu::VectorsOnDevice<T>& vectors = this->vectors_;
    const std::size_t stride = engine.source_stride();
    sum_operators::for_batches(harmonics_, [&](std::size_t first, std::size_t count, std::size_t batch) {
      const typename gpu::VectorsOnDevice<T>::Batch some{first, count, batch};
      const int k = static_cast<int>(batch);
      const gpu::Buffer& sums =
          engine.run_there(cpu::NearForm::kGreen, k, 3 + 2 * batch, batch,
                           [&](const gpu::Buffer& values, const gpu::Buffer&) { vectors.fill_green(x, some, stride, values); });
      const gpu::Buffer& adjoint = engine.run_there(
          cpu::NearForm::kGreenAdjoint, k, batch, batch + 3,
          [&](const gpu::Buffer& values, const gpu::Buffer& of_targets) { vectors.take_green(sums, some, stride, values, of_targets); });
      vectors.add_green_adjoint(adjoint, some, product);
    });
  }

 private:
  std::size_t harmonics_;
};

// What work(execution) makes on the engine's device; null if that is the processor, cannot, or has no room.
template <class T, class Work>
std::unique_ptr<SolveVectors> made_there(const SumEngine<T>& engine, const Work& work) {
  const std::shared_ptr<gpu::Execution> execution = engine.execution();
  if (!execution || !execution->usable(true)) return nullptr;
  std::unique_ptr<SolveVectors> made;
  try {
    execution->device().alone([&] { made = work(execution); });
  } catch (const gpu::DeviceError&) {
    return nullptr;
  }
  return made;
}

}  // namespace

template <class T>
std::unique_ptr<SolveVectors> energy_vectors(SumEngine<T>& engine, std::size_t points, const EnergyTerms& terms) {
  return made_there(engine, [&](const auto& there) { return std::make_unique<EnergyVectors<T>>(engine, there, points, terms); });
}

template <class T>
std::unique_ptr<SolveVectors> green_vectors(SumEngine<T>& engine, std::size_t points, const HarmonicValues& u) {
  return made_there(engine, [&](const auto& there) { return std::make_unique<GreenVectors<T>>(engine, there, points, u); });
}

template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<float>&, std::size_t, const EnergyTerms&);
template std::unique_ptr<SolveVectors> energy_vectors(SumEngine<double>&, std::size_t, const EnergyTerms&);
template std::unique_ptr<SolveVectors> green_vectors(SumEngine<float>&, std::size_t, const HarmonicValues&);
template std::unique_ptr<SolveVectors> green_vectors(SumEngine<double>&, std::size_t, const HarmonicValues&);

}  // namespace g3r

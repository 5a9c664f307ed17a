// Devices that kernels run on, found at run time: OpenCL's, and CUDA's where its compiler is installed. Neither is needed to build or run.
//
// Internal to src/gpu and its users in src/sum. All functions throw DeviceError; nothing is printed, and no state is shared between devices
// that are open at the same time.
#pragma once

#include "cpu/parallel.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace g3r::gpu {

/// Whatever a device or its driver complains of, one line: no memory, a kernel that does not compile, a device that is gone.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Its memory does not hold what is asked for; less may do.
class OutOfMemory : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// A device, not yet in use.
struct DeviceInfo {
  std::string name;                ///< "NVIDIA H100"
  std::string driver;              ///< "OpenCL 3.0 CUDA, driver 550.54"
  bool software = false;           ///< an OpenCL that runs on the processor
  bool doubles = false;            ///< has arithmetic in double
  std::size_t memory = 0;          ///< bytes; 0: not known
  std::size_t largest_buffer = 0;  ///< bytes
  std::size_t local_memory = 0;    ///< bytes per work-group
  std::size_t lanes_float = 1;     ///< numbers worked on together: more than 1 on processors
  std::size_t lanes_double = 1;
  bool cuda = false;
  std::uint64_t handle[2] = {0, 0};  ///< of the interface
};

/// Bytes in buffers.
struct HeldMemory {
  std::atomic<std::size_t> now{0};
  std::atomic<std::size_t> most{0};
};

/// Memory of a device, freed with it.
class Buffer {
 public:
  virtual ~Buffer() {
    if (held_) held_->now -= bytes_;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 protected:
  explicit Buffer(std::size_t bytes) : bytes_(bytes) {}

 private:
  friend class Device;
  std::size_t bytes_;
  std::shared_ptr<HeldMemory> held_;
};

/// Memory of the processor that a device copies to and from by itself, while the processor does something else.
class Staging {
 public:
  virtual ~Staging() = default;
  [[nodiscard]] unsigned char* data() const { return data_; }
  /// Until the last copy is done.
  virtual void wait() = 0;

 protected:
  unsigned char* data_ = nullptr;
};

/// A compiled function.
class Kernel {
 public:
  explicit Kernel(std::string name) : name_(std::move(name)) {}
  virtual ~Kernel() = default;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

/// A compiled source: its kernels are valid as long as it lives.
class Program {
 public:
  virtual ~Program() = default;
  /// A function of the source. Throws DeviceError if there is none.
  [[nodiscard]] virtual Kernel& kernel(const std::string& name) = 0;
};

/// An argument of a kernel: a buffer, or a number of the kernel's own type.
struct Argument {
  const Buffer* buffer = nullptr;
  unsigned char value[8] = {};
  std::size_t bytes = 0;

  Argument(const Buffer& b) : buffer(&b) {}  // NOLINT(google-explicit-constructor): arguments read as in a call
  template <class T>
  requires std::is_arithmetic_v<T> Argument(T v) : bytes(sizeof v) {  // NOLINT(google-explicit-constructor)
    std::memcpy(value, &v, sizeof v);
  }
};

/// A device in use. Work is done in the order it was asked for. Calls must not overlap: make them within alone().
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] const DeviceInfo& info() const { return info_; }
  /// Runs work() while no other thread has the device to itself; it may run loops, but must not call alone() of this device.
  void alone(parallel::FunctionRef<> work);
  /// Whether sums and products of doubles have the bytes of the processor's, so far as is known: neighbours rely on it.
  [[nodiscard]] bool rounds_alike() const { return info_.doubles && rounds_alike_; }
  void set_rounds_alike(bool alike) { rounds_alike_ = alike; }

  /// Memory that is not set to anything. Throws OutOfMemory where buffers would take more than info().memory, or the driver has no more.
  [[nodiscard]] std::unique_ptr<Buffer> allocate(std::size_t bytes);
  /// Bytes that buffers have taken at most at a time since the last call.
  [[nodiscard]] std::size_t take_most_memory() { return held_->most.exchange(held_->now); }
  /// The bytes at `from` may change as soon as it returns.
  void write(const Buffer& to, std::size_t offset, const void* from, std::size_t bytes);
  /// Hands the first `bytes` bytes of a buffer to use(offset, data, bytes), in parts of a multiple of `unit`, each while the next is
  /// copied.
  void read(const Buffer& from, std::size_t bytes, std::size_t unit,
            const std::function<void(std::size_t offset, const unsigned char* data, std::size_t bytes)>& use);
  virtual void finish() = 0;
  /// The compiled source, from now on kept by the device.
  [[nodiscard]] Program& program(const std::string& source);
  /// `groups` work-groups of `group_size` items, with `shared_bytes` of local memory in the kernel's last argument.
  void launch(Kernel& kernel, std::size_t groups, std::size_t group_size, const std::vector<Argument>& arguments, std::size_t shared_bytes);

  /// From now on every launch waits for its end, and its wall clock time is added to that of its kernel's name.
  void time_kernels() { timed_ = true; }
  /// Seconds by name since the last call; no longer timed.
  [[nodiscard]] std::map<std::string, double> take_kernel_seconds();

 protected:
  explicit Device(DeviceInfo info) : info_(std::move(info)) {}
  [[nodiscard]] virtual std::unique_ptr<Buffer> make_buffer(std::size_t bytes) = 0;
  [[nodiscard]] virtual std::unique_ptr<Staging> make_staging(std::size_t bytes) = 0;
  /// Copies from and to the beginning of `staging`, in the order of the launches; returns at once.
  virtual void start_write(const Buffer& to, std::size_t offset, Staging& staging, std::size_t bytes) = 0;
  virtual void start_read(const Buffer& from, std::size_t offset, Staging& staging, std::size_t bytes) = 0;
  virtual void start(Kernel& kernel, std::size_t groups, std::size_t group_size, const std::vector<Argument>& arguments,
                     std::size_t shared_bytes) = 0;
  /// Compiles a source, or takes the result from the user's cache (gpu/kernel_cache.h).
  [[nodiscard]] virtual std::unique_ptr<Program> compile(const std::string& source) = 0;
  /// For the destructors of devices: what was made in them goes first.
  void forget() {
    programs_.clear();
    staging_ = {};
  }

 private:
  // The k-th staging memory, when its last copy is done.
  Staging& staging(std::size_t k);

  DeviceInfo info_;
  std::shared_ptr<HeldMemory> held_ = std::make_shared<HeldMemory>();
  std::map<std::string, std::unique_ptr<Program>> programs_;
  std::array<std::unique_ptr<Staging>, 2> staging_;
  bool timed_ = false;
  bool rounds_alike_ = true;
  std::map<std::string, double> seconds_;
  std::mutex mutex_;
};

/// kNotLoaded: where an OpenCL that runs on the processor is the only one, its driver (some 90 MB of memory) is not loaded, nor listed.
enum class Software { kListed, kNotLoaded };

/// All devices, in a fixed order: GPUs before software. A GPU that both interfaces know is there once, through CUDA. Never throws for want
/// of a driver: the list is empty then.
[[nodiscard]] std::vector<DeviceInfo> list_devices(Software software = Software::kListed);

/// Takes a device into use.
[[nodiscard]] std::shared_ptr<Device> open_device(const DeviceInfo& info);

/// Keeps a device that works for the next call of this process: opening one and loading its kernels takes longer than many a sum.
void keep_device(std::shared_ptr<Device> device);
/// One that was kept, for the caller alone; null if there is none. What was opened before a fork is not given out after it.
[[nodiscard]] std::shared_ptr<Device> take_kept_device(const DeviceInfo& info);

}  // namespace g3r::gpu

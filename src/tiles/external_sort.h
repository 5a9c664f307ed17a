// Points of any number into Morton order, with bounded memory.
#pragma once

#include "cloud/canonical_cloud.h"
#include "tiles/records.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace g3r::tiles {

/// Sorts by the Morton code in a frame, ties by coordinates, then by index: one order, however many runs there were.
/// Runs lie in the folder until the sort is done; what a killed process has left is removed by the next.
class ExternalSort {
 public:
  /// `memory`: bytes, at least a few MiB are taken.
  ExternalSort(std::string folder, const Frame& frame, std::size_t memory, const std::atomic<bool>* cancel);
  ~ExternalSort();
  ExternalSort(const ExternalSort&) = delete;
  ExternalSort& operator=(const ExternalSort&) = delete;

  /// Throws IoError, Cancelled.
  void add(const Record& record);
  /// Calls take(code, record) for all records in order, once. Throws IoError, Cancelled.
  void finish(const std::function<void(std::uint64_t code, const Record&)>& take);

 private:
  struct Keyed {
    std::uint64_t code;
    Record record;
  };
  static bool before(const Keyed& a, const Keyed& b);
  [[nodiscard]] std::string run_path(std::size_t run) const;
  void write_run();

  std::string folder_;
  Frame frame_;
  std::size_t capacity_;  // records in memory
  const std::atomic<bool>* cancel_;
  std::vector<Keyed> buffer_;
  std::vector<std::string> runs_;
};

}  // namespace g3r::tiles

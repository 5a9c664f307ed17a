#include "tiles/external_sort.h"

#include "base/platform.h"
#include "cloud/morton.h"
#include "cpu/parallel_sort.h"
#include "io/output_file.h"

#include <algorithm>
#include <memory>
#include <queue>
#include <utility>

namespace g3r::tiles {
namespace {

constexpr std::size_t kLeastRecords = std::size_t{1} << 16;  // in memory: fewer make many small runs, which cost seeks
constexpr std::size_t kLeastAtOnce = 256;                    // records read from a run at once

// A run that is read from its beginning.
class Run {
 public:
  Run(std::string path, std::size_t at_once) : pieces_(std::move(path), at_once) {}
  const Record* next() {
    if (used_ == records_.size()) {
      pieces_.next(records_);
      used_ = 0;
      if (records_.empty()) return nullptr;
    }
    return &records_[used_++];
  }

 private:
  RecordPieces<Record> pieces_;
  std::vector<Record> records_;
  std::size_t used_ = 0;
};

}  // namespace

ExternalSort::ExternalSort(std::string folder, const Frame& frame, std::size_t memory, const std::atomic<bool>* cancel)
    : folder_(std::move(folder)), frame_(frame), capacity_(std::max(kLeastRecords, memory / sizeof(Keyed))), cancel_(cancel) {
  for (std::size_t run = 0; platform::remove_file(run_path(run)); ++run) {  // of a killed process
  }
}

std::string ExternalSort::run_path(std::size_t run) const { return folder_ + "/run-" + std::to_string(run) + ".bin"; }

ExternalSort::~ExternalSort() {
  for (const std::string& run : runs_) platform::remove_file(run);
}

bool ExternalSort::before(const Keyed& a, const Keyed& b) {
  if (a.code != b.code) return a.code < b.code;
  if (a.record.point != b.record.point) return a.record.point < b.record.point;
  return a.record.index < b.record.index;
}

void ExternalSort::add(const Record& record) {
  if (buffer_.size() == capacity_) write_run();
  buffer_.push_back({morton_code(frame_.to_unit(record.point)), record});
}

void ExternalSort::write_run() {
  parallel::sort(buffer_.begin(), buffer_.end(), before);
  runs_.push_back(run_path(runs_.size()));
  io::OutputFile file(runs_.back(), cancel_);
  for (const Keyed& keyed : buffer_) file.write(&keyed.record, sizeof keyed.record);
  file.commit();
  buffer_.clear();
}

void ExternalSort::finish(const std::function<void(std::uint64_t, const Record&)>& take) {
  if (runs_.empty()) {
    parallel::sort(buffer_.begin(), buffer_.end(), before);
    for (const Keyed& keyed : buffer_) take(keyed.code, keyed.record);
    std::vector<Keyed>().swap(buffer_);
    return;
  }
  if (!buffer_.empty()) write_run();
  std::vector<Keyed>().swap(buffer_);
  std::vector<std::unique_ptr<Run>> runs;
  using Head = std::pair<Keyed, std::size_t>;
  const auto later = [](const Head& a, const Head& b) { return before(b.first, a.first); };
  std::priority_queue<Head, std::vector<Head>, decltype(later)> heads(later);
  const auto advance = [&](std::size_t run) {
    if (const Record* record = runs[run]->next()) heads.push({{morton_code(frame_.to_unit(record->point)), *record}, run});
  };
  for (const std::string& path : runs_) {
    runs.push_back(std::make_unique<Run>(path, std::max(kLeastAtOnce, capacity_ / runs_.size())));
    advance(runs.size() - 1);
  }
  while (!heads.empty()) {
    const auto [keyed, run] = heads.top();
    heads.pop();
    take(keyed.code, keyed.record);
    advance(run);
  }
}

}  // namespace g3r::tiles

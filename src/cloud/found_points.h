// What a search in a k-d tree keeps of the points that it comes across: add() takes one, reach() is the squared distance up to which more
// are asked for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace g3r {

/// Whether a point comes before another one: the nearer first, and of points as far away the one with the smaller index.
inline bool is_before(double squared, std::uint32_t point, double other_squared, std::uint32_t other) {
  return squared < other_squared || (squared == other_squared && point < other);
}

/// The k nearest points so far, in the order of is_before(), in arrays of the caller. O(k) for each that is kept.
class NearestPoints {
 public:
  NearestPoints(std::size_t k, std::uint32_t* index, double* squared)
      : k_(k), index_(index), squared_(squared), reach_(k > 0 ? HUGE_VAL : -1) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double reach() const { return reach_; }
  void add(double squared, std::uint32_t point) {
    if (size_ == k_) {
      if (!is_before(squared, point, squared_[k_ - 1], index_[k_ - 1])) return;
    } else {
      ++size_;
    }
    std::size_t at = size_ - 1;
    for (; at > 0 && is_before(squared, point, squared_[at - 1], index_[at - 1]); --at) {
      squared_[at] = squared_[at - 1];
      index_[at] = index_[at - 1];
    }
    squared_[at] = squared;
    index_[at] = point;
    if (size_ == k_) reach_ = squared_[k_ - 1];
  }

 private:
  std::size_t k_;
  std::uint32_t* index_;
  double* squared_;
  std::size_t size_ = 0;
  double reach_;
};

/// The same of many, which are sorted at the end: whenever there are twice as many, the farther half goes. O(1) for each in the mean.
class ManyNearestPoints {
 public:
  explicit ManyNearestPoints(std::size_t k) : k_(k) { found_.reserve(2 * k); }
  [[nodiscard]] double reach() const { return reach_; }
  void add(double squared, std::uint32_t point) {
    found_.emplace_back(squared, point);
    if (found_.size() == 2 * k_) keep_nearest();
  }
  void sort_into(std::uint32_t* index, double* squared) {
    if (found_.size() > k_) keep_nearest();
    std::sort(found_.begin(), found_.end());
    for (const auto& [distance, point] : found_) {
      *index++ = point;
      *squared++ = distance;
    }
  }

 private:
  void keep_nearest() {
    const auto last = found_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(found_.begin(), last, found_.end());
    reach_ = last->first;
    found_.resize(k_);
  }

  std::size_t k_;
  double reach_ = HUGE_VAL;
  std::vector<std::pair<double, std::uint32_t>> found_;  // squared distances and points
};

/// The k nearest of the points with a mark other than 0.
class NearestMarkedPoints : public NearestPoints {
 public:
  NearestMarkedPoints(std::size_t k, const std::vector<std::uint8_t>& marks, std::uint32_t* index, double* squared)
      : NearestPoints(k, index, squared), marks_(marks) {}
  void add(double squared, std::uint32_t point) {
    if (marks_[point] != 0) NearestPoints::add(squared, point);
  }

 private:
  const std::vector<std::uint8_t>& marks_;
};

/// The nearest of the points whose squared distance is below the first reach; `none` if there is no such point.
class NearestWithin {
 public:
  NearestWithin(double reach, std::uint32_t none) : point_(none), squared_(reach) {}
  [[nodiscard]] std::uint32_t point() const { return point_; }
  [[nodiscard]] double reach() const { return squared_; }
  void add(double squared, std::uint32_t point) {
    if (!(squared < squared_ || (found_ && squared == squared_ && point < point_))) return;
    found_ = true;
    squared_ = squared;
    point_ = point;
  }

 private:
  bool found_ = false;
  std::uint32_t point_;
  double squared_;
};

/// All points whose squared distance is below the reach, in no order, until they are more than `most`.
class AllWithin {
 public:
  AllWithin(double reach, std::size_t most, std::vector<std::uint32_t>& index) : reach_(reach), most_(most), index_(index) {}
  [[nodiscard]] double reach() const { return index_.size() > most_ ? -1 : reach_; }
  void add(double squared, std::uint32_t point) {
    if (squared < reach_) index_.push_back(point);
  }

 private:
  double reach_;
  std::size_t most_;
  std::vector<std::uint32_t>& index_;
};

}  // namespace g3r

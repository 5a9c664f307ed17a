#include "cloud/point_set.h"

#include "cloud/noise.h"
#include "cloud/spacing.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

namespace g3r {

struct PointSet::Known {
  std::vector<Vec3> points;
  std::mutex making;  // tree, near and local
  std::atomic<bool> has_tree{false}, has_near{false}, has_local{false};
  std::once_flag smoothed_made, spacing_made, steps_made;
  std::unique_ptr<Neighbours> tree;
  std::vector<std::uint32_t> near;
  std::vector<double> local;
  std::vector<double> smoothed;
  double spacing = 0;
  Vec3 steps{0, 0, 0};
  Views views;
};

PointSet::PointSet() : known_(std::make_shared<Known>()) {}

PointSet::PointSet(std::vector<Vec3> points, Views views) : PointSet() {
  known_->points = std::move(points);
  known_->views = std::move(views);
}

const std::vector<Vec3>& PointSet::points() const { return known_->points; }
const Views& PointSet::views() const { return known_->views; }
void PointSet::set_views(Views views) { known_->views = std::move(views); }
std::size_t PointSet::near_count() const { return std::min(kSpacingNeighbours, size()); }

const Neighbours& PointSet::tree() const {
  if (!known_->has_tree) {
    const std::scoped_lock lock(known_->making);
    if (!known_->tree) known_->tree = std::make_unique<Neighbours>(known_->points);
    known_->has_tree = true;
  }
  return *known_->tree;
}

const std::vector<std::uint32_t>& PointSet::near() const {
  if (!known_->has_near) {
    const Neighbours& all = tree();
    const std::scoped_lock lock(known_->making);
    if (known_->near.empty()) known_->near = all.of_all(kSpacingNeighbours);
    known_->has_near = true;
  }
  return known_->near;
}

void PointSet::release_neighbours() const {
  const std::scoped_lock lock(known_->making);
  known_->has_tree = known_->has_near = known_->has_local = false;
  known_->tree.reset();
  std::vector<std::uint32_t>().swap(known_->near);
  std::vector<double>().swap(known_->local);
}

const std::vector<double>& PointSet::local_spacing() const {
  if (!known_->has_local) {
    const std::vector<std::uint32_t>& around = near();
    const std::scoped_lock lock(known_->making);
    if (known_->local.empty()) known_->local = g3r::local_spacing(known_->points, around);
    known_->has_local = true;
  }
  return known_->local;
}

const std::vector<double>& PointSet::smoothed_spacing() const {
  std::call_once(known_->smoothed_made, [this] { known_->smoothed = g3r::smoothed_spacing(local_spacing(), near()); });
  return known_->smoothed;
}

double PointSet::spacing() const {
  std::call_once(known_->spacing_made, [this] { known_->spacing = typical_spacing(local_spacing()); });
  return known_->spacing;
}

const Vec3& PointSet::rounding_steps() const {
  std::call_once(known_->steps_made, [this] { known_->steps = g3r::rounding_steps(known_->points, spacing()); });
  return known_->steps;
}

}  // namespace g3r

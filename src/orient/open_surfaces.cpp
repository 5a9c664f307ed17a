#include "orient/open_surfaces.h"

#include "base/disjoint_sets.h"
#include "base/median.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/sites.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/certificate.h"
#include "orient/sign_graph.h"
#include "orient/two_walls.h"
#include "solve/part_system.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace g3r {
namespace {

using vector::dot;

constexpr std::size_t kScales = 3;  // that are tried: the rings of a spinning scanner and roofs need the coarsest
constexpr double kNoiseScale = 2;   // standard deviations of the noise between sites, at least
// Site distances that are far: longer edges cross gaps, and where sides do not agree a field so wide sees what is around; wider ones turn
// the rims of small surfaces.
constexpr double kFar = 4;
// Graph.
constexpr std::size_t kAdjacent = 10;  // nearest sites that a site is connected with: 12 lead from a thin wall to the next under noise
// Hypothesis.
constexpr int kTurns = 3;  // rounds of the winding gradient
// Verdict.
constexpr double kUnrest = 0.08;      // mean of a part that is open: closed ones have up to 0.06, open ones 0.1 to 0.3
constexpr double kUnrestNoisy = 0.2;  // the same where noise hides thin walls, whose field is open in places
constexpr double kNoJump = 0.6;       // mean jump defect of a part whose sides change from site to site, or of two walls
constexpr double kNoJumpNoisy = 0.8;  // the same under noise
constexpr double kEncloses = 0.7;     // enclosure under noise that no bowl up to a half sphere has, so that the part is a closed one

// Places where the unrest of the given normals is that of an open surface, and what to try there.
class Search {
 public:
  Search(const PointSet& set, double noise, const SumPlan& sums, const std::atomic<bool>* cancel)
      : set_(set), points_(set.points()), noise_(noise), sums_(sums), cancel_(cancel) {
    finest_ = place_sites(set_, site_distance(set.size(), set.spacing(), noise));
    DisjointSets parts(finest_.size());
    for (const SignEdge& edge : edges_of(finest_)) parts.join(edge.a, edge.b);
    std::vector<std::uint32_t> number(finest_.size(), 0);
    for (std::uint32_t s = 0; s < finest_.size(); ++s) {
      const std::size_t first = parts.find(s);  // the smallest site of its part
      if (first == s) {
        number[s] = static_cast<std::uint32_t>(members_.size());
        members_.emplace_back();
      }
      part_.push_back(number[first]);
      members_[part_.back()].push_back(s);
    }
    for (std::size_t s = 0; s < finest_.size(); ++s) {
      reach_.push_back(std::sqrt(static_cast<double>(members_[part_[s]].size())) / 2 * finest_.spacing()[s]);
    }
  }

  [[nodiscard]] const Sites& sites() const { return finest_; }
  [[nodiscard]] std::size_t parts() const { return members_.size(); }
  [[nodiscard]] std::size_t size(std::uint32_t part) const { return members_[part].size(); }
  [[nodiscard]] std::uint32_t part_of_point(std::size_t i) const { return part_[finest_.site_of[i]]; }

  // Mean of `value` over the sites of every part; negative values are left out, 0 where there is none.
  [[nodiscard]] std::vector<double> mean_of_parts(const std::vector<double>& value) const {
    std::vector<double> mean(members_.size(), 0);
    for (std::size_t p = 0; p < members_.size(); ++p) {
      double count = 0;
      for (const std::uint32_t s : members_[p]) {
        if (value[s] < 0) continue;
        mean[p] += value[s];
        ++count;
      }
      if (count > 0) mean[p] /= count;
    }
    return mean;
  }

  // Mean direction of the points of every site.
  [[nodiscard]] std::vector<Vec3> at_sites(const std::vector<Vec3>& normals) const {
    std::vector<Vec3> mean(finest_.size(), Vec3{0, 0, 0});
    for (std::size_t i = 0; i < normals.size(); ++i) mean[finest_.site_of[i]] = vector::add(mean[finest_.site_of[i]], normals[i]);
    for (std::size_t s = 0; s < mean.size(); ++s) {
      mean[s] = vector::normalised(mean[s]);
      if (dot(mean[s], mean[s]) == 0) mean[s] = finest_.axis[s];
    }
    return mean;
  }

  [[nodiscard]] Certificate test(const std::vector<Vec3>& normals) const {
    return certify(finest_, at_sites(normals), reach_, sums_, cancel_);
  }

  [[nodiscard]] JumpDefects jump_defects(const std::vector<std::vector<Vec3>>& hypotheses) const {
    std::vector<std::vector<Vec3>> normals;
    for (const std::vector<Vec3>& hypothesis : hypotheses) normals.push_back(at_sites(hypothesis));
    return g3r::jump_defects(finest_, std::move(normals), sums_, cancel_);
  }

  // `unrest`: of the sites.
  [[nodiscard]] bool has_two_walls(std::uint32_t part, const std::vector<double>& unrest) const {
    return on_two_walls(set_, finest_, members_[part], noise_, unrest, kUnrest);
  }

  // Twice the mean of w at the sites of a part, w of that part alone: 1 on a closed surface, 0 on a plane, -1 on one inside out.
  [[nodiscard]] double enclosure(std::uint32_t part, const std::vector<Vec3>& normals) const {
    std::vector<Vec3> points;
    std::vector<Vec3> eta;
    for (const std::uint32_t s : members_[part]) {
      points.push_back(finest_.points()[s]);
      eta.push_back(vector::scale(normals[s], finest_.side(s) * finest_.side(s)));
    }
    FastSum field(points, Widths(kBetweenSites * finest_.set.spacing()), sum_plan(kContinuedAccuracy, points.size()), cancel_);
    double sum = 0;
    for (const double w : field.winding(eta)) sum += w;
    return 2 * sum / static_cast<double>(points.size());
  }

  // Normals of all points from the signs that neighbours agree on: the sides of every scale, the directions of the finest, so that they
  // differ in sides only.
  [[nodiscard]] std::vector<std::vector<Vec3>> hypotheses() const {
    std::vector<std::vector<Vec3>> all{by_agreement(finest_)};
    Sites sites = coarser_than(finest_);
    while (all.size() < kScales && sites.size() >= kFewestSites) {
      std::vector<Vec3> normals = by_agreement(sites);
      for (std::size_t i = 0; i < normals.size(); ++i) {
        normals[i] = vector::scale(all.front()[i], dot(all.front()[i], normals[i]) < 0 ? -1 : 1);
      }
      all.push_back(std::move(normals));
      sites = coarser_than(sites);
    }
    return all;
  }

  // Normals of all points from the field of every part's best hypothesis, so wide that it sees no grooves.
  [[nodiscard]] std::vector<Vec3> seen_from_afar(const std::vector<std::vector<Vec3>>& tried, const std::vector<std::size_t>& best) const {
    std::vector<Vec3> chosen(points_.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = tried[best[part_of_point(i)]][i];
    const FastSum field(finest_.points(), Widths(kFar * finest_.set.spacing()), sums_, cancel_);
    return unit_normals(field.winding_gradient_at(areas_of(finest_, at_sites(chosen)), points_, cancel_), chosen).normals;
  }

 private:
  static std::vector<Vec3> areas_of(const Sites& sites, std::vector<Vec3> normals) {
    for (std::size_t s = 0; s < normals.size(); ++s) normals[s] = vector::scale(normals[s], sites.spacing()[s] * sites.spacing()[s]);
    return normals;
  }

  [[nodiscard]] Sites coarser_than(const Sites& sites) const {
    return place_sites(set_, std::max(kFirstDistance * set_.spacing(), 2 * sites.distance));
  }

  static double reach_of(const Sites& sites, std::uint32_t a, std::uint32_t b) {
    return sites.distance > 0 ? sites.distance : (sites.spacing()[a] + sites.spacing()[b]) / 2;
  }

  static SignEdge edge_of(const Sites& sites, std::uint32_t a, std::uint32_t b) {
    const Vec3 d = vector::subtract(sites.points()[b], sites.points()[a]);
    const double squared = dot(d, d);
    const double reach = reach_of(sites, a, b);
    if (squared > kFar * kFar * reach * reach) return {a, a, 0};
    const double mirrored = dot(sites.axis[a], sites.axis[b]) -
                            2 * dot(sites.axis[a], d) * dot(sites.axis[b], d) / std::max(squared, std::numeric_limits<double>::min());
    // Sites whose surroundings are a ball still follow their neighbours.
    const double flat = std::max(kRidge, 1 - sites.flatness[a]) * std::max(kRidge, 1 - sites.flatness[b]);
    return {a, b, flat * std::exp(-squared / (2 * kWeightReach * kWeightReach * reach * reach)) * mirrored};
  }

  // Every pair of near sites once, from the nearest sites of each.
  static std::vector<SignEdge> edges_of(const Sites& sites) {
    const std::size_t count = sites.size();
    const std::vector<std::uint32_t>& near = sites.set.near();
    const std::size_t stride = sites.set.near_count();
    const std::size_t adjacent = std::min(kAdjacent + 1, stride);
    std::vector<SignEdge> edges;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < adjacent; ++k) {
        const std::uint32_t j = near[i * stride + k];
        const auto first = near.begin() + static_cast<std::ptrdiff_t>(j * stride);
        const auto last = first + static_cast<std::ptrdiff_t>(adjacent);
        if (j == i || (j < i && std::find(first, last, i) != last)) continue;
        const SignEdge edge = edge_of(sites, i, j);
        if (edge.a != edge.b) edges.push_back(edge);
      }
    }
    return edges;
  }

  [[nodiscard]] std::vector<Vec3> by_agreement(const Sites& sites) const {
    const std::size_t count = sites.size();
    const Signs signs = agree_on_signs(count, edges_of(sites));  // 110 bytes a site, made again rather than kept
    std::vector<Vec3> normals(count);
    for (std::size_t s = 0; s < count; ++s) normals[s] = vector::scale(sites.axis[s], signs.sign[s]);
    const double spacing = sites.set.spacing();
    FastSum wide(sites.points(), Widths(kResolved * spacing), sums_, cancel_);
    for (int turn = 0; turn < kTurns; ++turn) normals = refine_normals(wide, areas_of(sites, normals)).normals;
    // Directions from a narrower field, where its side is the same.
    const FastSum field(wide, Widths(kBetweenSites * spacing));
    std::vector<Vec3> sided(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) sided[i] = normals[sites.site_of[i]];
    std::vector<Vec3> narrow = unit_normals(field.winding_gradient_at(areas_of(sites, normals), points_, cancel_), sided).normals;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (dot(narrow[i], sided[i]) > 0) sided[i] = narrow[i];
    }
    return sided;
  }

  const PointSet& set_;
  const std::vector<Vec3>& points_;
  double noise_;
  SumPlan sums_;
  const std::atomic<bool>* cancel_;
  Sites finest_;
  std::vector<std::uint32_t> part_;                  // of every site
  std::vector<std::vector<std::uint32_t>> members_;  // the sites of every part
  std::vector<double> reach_;                        // half the side of a square of as many sites as the part has
};

// By the first axis from z to x that the sum of the normals is not level to, as far as a float tells.
bool faces_down(const Vec3& sum) {
  const double size = std::max({std::abs(sum[0]), std::abs(sum[1]), std::abs(sum[2])});
  for (const std::size_t axis : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
    if (std::abs(sum[axis]) > std::numeric_limits<float>::epsilon() * size) return sum[axis] < 0;
  }
  return false;
}

// Of every site, how far the normals of its points and of those of the sites around it are one direction: the length of their mean (the
// mean resultant length of directional statistics; Mardia and Jupp, "Directional Statistics", 2000), the mean cosine between them and it: 1
// where all are the same, near 0 where they face either way, as in two walls or patches closer together than the sites.
std::vector<double> concentration(const Search& search, const std::vector<Vec3>& normals) {
  const Sites& sites = search.sites();
  std::vector<Vec3> sum(sites.size(), Vec3{0, 0, 0});
  std::vector<double> count(sites.size(), 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    sum[sites.site_of[i]] = vector::add(sum[sites.site_of[i]], normals[i]);
    ++count[sites.site_of[i]];
  }
  const std::vector<std::uint32_t>& near = sites.set.near();
  const std::size_t stride = sites.set.near_count();
  std::vector<double> out(sites.size());
  for (std::size_t s = 0; s < sites.size(); ++s) {
    Vec3 around{};
    double all = 0;
    for (std::size_t k = 0; k < std::min(kClosest + 1, stride); ++k) {
      around = vector::add(around, sum[near[s * stride + k]]);
      all += count[near[s * stride + k]];
    }
    out[s] = std::sqrt(dot(around, around)) / all;
  }
  return out;
}

// How far the certificate of the given normals shows the sides of the points to be right; `exact`: there is no noise. What is as restless
// as an open surface is not shown to be closed, and nothing else says that its sides are right.
std::vector<float> certified(const Search& search, const Certificate& certificate, const std::vector<Vec3>& normals, bool exact) {
  const std::vector<double> unrest = search.mean_of_parts(certificate.unrest);
  const std::vector<Vec3> at_sites = search.at_sites(normals);
  const std::vector<double> one_way = exact ? std::vector<double>{} : concentration(search, normals);
  const bool is_thinned = search.sites().distance > 0;
  std::vector<float> out(normals.size(), 0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t s = search.sites().site_of[i];
    if (dot(normals[i], at_sites[s]) <= 0) continue;
    const double jump = is_thinned ? 1 - certificate.scaled_defect[s] : certificate.jump[s];
    const double restless = std::min(1.0, unrest[search.part_of_point(i)] / (is_thinned ? kUnrestNoisy : kUnrest));
    out[i] = static_cast<float>((exact ? 1 : one_way[s]) * std::clamp(jump, 0.0, 1.0) * (1 - restless * restless));
  }
  return out;
}

bool any(const std::vector<std::uint8_t>& parts) {
  return std::any_of(parts.begin(), parts.end(), [](std::uint8_t part) { return part != 0; });
}

// What is known of every part.
struct Verdict {
  std::vector<std::uint8_t> is_open;
  std::vector<std::uint8_t> is_doubtful;     // neither at rest nor shown to be open
  std::vector<std::uint8_t> is_turned;       // of those, whose sides are more certain by a hypothesis
  std::vector<std::vector<double>> defects;  // jump defects of the sites, of every hypothesis
  std::vector<std::size_t> best;             // of the hypotheses
  std::vector<double> defect;                // mean jump defect of the best
  std::vector<double> enclosure;             // of the best
};

// From the field of the given normals, unrest and jump defects being means of the parts.
Verdict suspect(const Search& search, const Certificate& given, const std::vector<double>& unrest, const std::vector<double>& defect,
                double noise) {
  const std::size_t parts = search.parts();
  const std::vector<std::uint8_t> none(parts, 0);
  Verdict verdict{
      none, none, none, {}, std::vector<std::size_t>(parts, 0), std::vector<double>(parts, HUGE_VAL), std::vector<double>(parts, 0)};
  for (std::uint32_t p = 0; p < parts; ++p) {
    if (search.size(p) < kFewestSites) continue;
    if (unrest[p] <= kUnrest && defect[p] <= (noise > 0 ? kNoJumpNoisy : kNoJump)) continue;
    verdict.is_open[p] = search.has_two_walls(p, given.unrest) ? 0 : 1;
    verdict.is_doubtful[p] = verdict.is_open[p] == 0 && unrest[p] > kUnrest ? 1 : 0;
  }
  return verdict;
}

// The best hypothesis of every part. Where unrest alone does not decide it has to halve the defect of what was given; else nothing is
// certain, if the part is not at rest either.
void choose(const Search& search, const std::vector<std::vector<Vec3>>& tried, const std::vector<double>& unrest,
            const std::vector<double>& defect, double noise, Verdict& verdict) {
  JumpDefects defects = search.jump_defects(tried);
  std::vector<double> least(unrest.size(), HUGE_VAL);
  for (std::size_t h = 0; h < tried.size(); ++h) {
    const std::vector<double> all = search.mean_of_parts(defects.all[h]);
    const std::vector<double> own = search.mean_of_parts(defects.own[h]);
    for (std::size_t p = 0; p < all.size(); ++p) {
      if (all[p] + own[p] >= least[p]) continue;
      least[p] = all[p] + own[p];
      verdict.defect[p] = all[p];
      verdict.best[p] = h;
    }
  }
  verdict.defects = std::move(defects.all);
  for (std::size_t h = 0; h < tried.size(); ++h) {
    const std::vector<Vec3> at_sites = search.at_sites(tried[h]);
    for (std::uint32_t p = 0; p < unrest.size(); ++p) {
      if (verdict.is_open[p] != 0 && verdict.best[p] == h) verdict.enclosure[p] = search.enclosure(p, at_sites);
    }
  }
  const double most_unrest = search.sites().distance > 0 ? kUnrestNoisy : kUnrest;
  for (std::size_t p = 0; p < unrest.size(); ++p) {
    if (verdict.is_open[p] == 0) continue;
    const bool is_better = unrest[p] > most_unrest || 2 * verdict.defect[p] <= defect[p];
    // Noise makes one wall of two: what encloses nearly everything is a closed surface whose thin parts it hides.
    const bool is_enclosed = noise > 0 && std::abs(verdict.enclosure[p]) >= kEncloses;
    if (is_better && !is_enclosed) continue;
    verdict.is_open[p] = 0;
    verdict.is_doubtful[p] = unrest[p] > kUnrest ? 1 : 0;
    // What encloses little has no outside that tells which way to turn it.
    const bool has_outside = std::abs(verdict.enclosure[p]) >= kEncloses;
    verdict.is_turned[p] = verdict.is_doubtful[p] != 0 && has_outside && verdict.defect[p] < defect[p] ? 1 : 0;
  }
}

// Turns the points of doubtful parts to the sides of the best hypothesis, but where points of both sides are mixed: those may be on two
// walls. Patches that are turned the other way are not, but at their rims, which they are no longer once the patches are turned.
void turn_doubtful(const Search& search, const std::vector<std::vector<Vec3>>& tried, const Verdict& verdict, std::vector<Vec3>& normals) {
  for (bool is_turned = true; is_turned;) {
    is_turned = false;
    const std::vector<double> one_way = concentration(search, normals);
    for (std::uint32_t i = 0; i < normals.size(); ++i) {
      const std::uint32_t p = search.part_of_point(i);
      if (verdict.is_turned[p] == 0 || one_way[search.sites().site_of[i]] < kSameSide) continue;
      if (dot(normals[i], tried[verdict.best[p]][i]) * verdict.enclosure[p] >= 0) continue;
      normals[i] = vector::scale(normals[i], -1);
      is_turned = true;
    }
  }
}

// The normals of open parts, with their outside where they have one.
OpenSurfaces choose(const Search& search, const std::vector<std::vector<Vec3>>& tried, const Verdict& verdict, std::vector<float> certified,
                    std::vector<Vec3>& normals) {
  OpenSurfaces found;
  found.certified = std::move(certified);
  found.part.assign(normals.size(), OpenSurfaces::kNone);
  found.certainty.assign(normals.size(), 1);
  found.agrees.assign(normals.size(), 0);
  const std::vector<Vec3> wide = tried.empty() ? std::vector<Vec3>{} : search.seen_from_afar(tried, verdict.best);
  std::vector<Vec3> sum(search.parts(), Vec3{0, 0, 0});
  std::vector<std::uint32_t> first(search.parts(), OpenSurfaces::kNone);
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = search.part_of_point(i);
    if (verdict.is_doubtful[p] != 0) found.certainty[i] = kUndecided;
    if (verdict.is_open[p] == 0) continue;
    first[p] = std::min(first[p], i);
    found.part[i] = first[p];
    found.agrees[i] = verdict.defect[p] < kUndecided ? 1 : 0;
    const double agreed = 1 - verdict.defects[verdict.best[p]][search.sites().site_of[i]];
    // A side that shows less than half of the jump has more against it than for it, and what is around tells.
    normals[i] = agreed < kUndecided ? wide[i] : tried[verdict.best[p]][i];
    found.certified[i] = static_cast<float>(std::clamp(agreed / kUndecided, 0.0, 1.0));
    sum[p] = vector::add(sum[p], normals[i]);
  }
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = search.part_of_point(i);
    if (verdict.is_open[p] == 0) continue;
    const double enclosure = verdict.enclosure[p];
    const bool decided = std::abs(enclosure) > kUndecided;
    if (decided ? enclosure < 0 : faces_down(sum[p])) normals[i] = vector::scale(normals[i], -1);
    found.certainty[i] = decided ? static_cast<float>(std::min(1.0, std::abs(enclosure))) : kUndecided;
  }
  return found;
}

// The points of marked parts, ascending.
std::vector<std::uint32_t> points_of(const Search& search, const std::vector<std::uint8_t>& marked) {
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < search.sites().site_of.size(); ++i) {
    if (marked[search.part_of_point(i)] != 0) some.push_back(i);
  }
  return some;
}

// Looks at some of the points without the others, which are closed.
void find_among(const std::vector<std::uint32_t>& some, const PointSet& set, double noise, const SumPlan& sums,
                const std::atomic<bool>* cancel, std::vector<Vec3>& normals, OpenSurfaces& found) {
  std::vector<Vec3> sides = values_at(some, normals);
  const OpenSurfaces here = find_open_surfaces(PointSet(values_at(some, set.points())), noise, sums, sides, cancel);
  if (!here.part.empty() && found.part.empty()) {
    found.part.assign(set.size(), OpenSurfaces::kNone);
    found.certainty.assign(set.size(), 1);
    found.agrees.assign(set.size(), 0);
  }
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    normals[i] = sides[k];
    found.certified[i] = here.certified[k];
    if (here.part.empty()) continue;
    found.part[i] = here.part[k] == OpenSurfaces::kNone ? OpenSurfaces::kNone : some[here.part[k]];
    found.certainty[i] = here.certainty[k];
    found.agrees[i] = here.agrees[k];
  }
}

}  // namespace

double unsure_share(const OpenSurfaces& surfaces, const std::vector<float>& confidence) {
  std::size_t unsure = 0;
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    const bool is_open = surfaces.is_open(i);
    const bool not_shown = !is_open && confidence[i] == kUndecided && confidence.size() >= kFewestSites;
    unsure += confidence[i] < kUndecided || not_shown ? 1 : 0;
  }
  return static_cast<double>(unsure) / static_cast<double>(confidence.size());
}

std::vector<float> certified_sides(const PointSet& set, double noise, const SumPlan& sums, const std::vector<Vec3>& normals,
                                   const std::atomic<bool>* cancel) {
  if (set.size() < kFewestSites) return std::vector<float>(set.size(), 0);
  const Search search(set, noise, sums, cancel);
  const Certificate given = search.test(normals);
  return certified(search, given, normals, noise == 0);
}

void make_room_for_sums(const PointSet& set) {
  if (set.size() > kMostSites) set.release_neighbours();
}

double site_distance(std::size_t points, double spacing, double noise) {
  const double all = std::sqrt(static_cast<double>(points) / static_cast<double>(kMostSites));
  const double least = std::max(kNoiseScale * noise, all > 1 ? kFirstDistance * all * spacing : 0);
  return least < kFirstDistance / 2 * spacing ? 0 : std::max(kFirstDistance * spacing, least);
}

OpenSurfaces find_open_surfaces(const PointSet& set, double noise, const SumPlan& sums, std::vector<Vec3>& normals,
                                const std::atomic<bool>* cancel) {
  if (set.size() < kFewestSites) {  // no side can be certified
    OpenSurfaces unknown;
    unknown.certified.assign(set.size(), 0);
    return unknown;
  }
  const Search search(set, noise, sums, cancel);
  const Certificate given = search.test(normals);
  const std::vector<double> unrest = search.mean_of_parts(given.unrest);
  const std::vector<double> defect = search.mean_of_parts(given.jump_defect);
  Verdict verdict = suspect(search, given, unrest, defect, noise);
  const std::vector<std::uint32_t> suspects = points_of(search, verdict.is_open);
  const bool are_some = !suspects.empty() && suspects.size() < set.size();
  if (are_some) std::fill(verdict.is_open.begin(), verdict.is_open.end(), std::uint8_t{0});
  std::vector<std::vector<Vec3>> tried;
  if (any(verdict.is_open)) {
    tried = search.hypotheses();
    choose(search, tried, unrest, defect, noise, verdict);
  }
  const bool are_turned = any(verdict.is_turned);
  if (are_turned) turn_doubtful(search, tried, verdict, normals);
  std::vector<float> shown = certified(search, are_turned ? search.test(normals) : given, normals, noise == 0);
  OpenSurfaces found;
  if (any(verdict.is_open) || any(verdict.is_doubtful)) {
    found = choose(search, tried, verdict, std::move(shown), normals);
  } else {
    found.certified = std::move(shown);
  }
  found.uncertified = noise == 0 ? kUndecided : 0;
  if (are_some) find_among(suspects, set, noise, sums, cancel, normals, found);
  return found;
}

}  // namespace g3r

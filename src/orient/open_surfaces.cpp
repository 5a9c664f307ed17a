#include "orient/open_surfaces.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/agreement.h"
#include "orient/certificate.h"
#include "orient/certified_sides.h"
#include "orient/outside.h"
#include "orient/restless.h"
#include "orient/site_parts.h"
#include "orient/two_walls.h"
#include "solve/part_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r {
namespace {

using vector::dot;

// Mean jump defect from which the sides of a part under noise are not those of a closed surface: they change from site to site, or it is
// two walls. Without noise it is kMostOf.
constexpr double kNoJumpNoisy = 0.8;

bool is_any_marked(const std::vector<std::uint8_t>& parts) {
  return std::any_of(parts.begin(), parts.end(), [](std::uint8_t part) { return part != 0; });
}

// What the field of the given normals says of the sites, and in the mean of every part.
struct Given {
  Certificate of_sites;
  std::vector<double> unrest;
  std::vector<double> defect;
};

// What is known of every part.
struct Verdict {
  std::vector<std::vector<std::uint32_t>> restless;  // the sites where its field is not that of a closed surface: all, or those of pieces
  std::vector<std::uint8_t> is_open;
  std::vector<std::uint8_t> is_doubtful;     // neither at rest nor shown to be open
  std::vector<std::uint8_t> is_turned;       // of closed ones: whose sides are more certain by a hypothesis, where they are restless
  std::vector<std::vector<double>> defects;  // jump defects of the sites, of every hypothesis
  std::vector<std::size_t> best;             // of the hypotheses
  std::vector<double> defect;                // mean jump defect of the best
  std::vector<double> enclosure;             // of the best
};

// From the field of the given normals. A part that is closed but for a place may be open all the same, as an object is that stands on a
// table.
Verdict suspected_parts(const SiteParts& parts, const Given& given, double noise) {
  const std::size_t count = parts.count();
  const std::vector<std::uint8_t> none(count, 0);
  Verdict verdict{std::vector<std::vector<std::uint32_t>>(count),
                  none,
                  none,
                  none,
                  {},
                  std::vector<std::size_t>(count, 0),
                  std::vector<double>(count, HUGE_VAL),
                  std::vector<double>(count, 0)};
  for (std::uint32_t p = 0; p < count; ++p) {
    const std::vector<std::uint32_t>& part = parts.members(p);
    if (part.size() < kFewestSites) continue;
    if (given.unrest[p] <= kUnrest && given.defect[p] <= (noise > 0 ? kNoJumpNoisy : kMostOf)) {
      verdict.restless[p] = restless_pieces(parts, p, given.of_sites.unrest, noise);
      verdict.is_open[p] = verdict.restless[p].empty() ? 0 : 1;
      continue;
    }
    verdict.restless[p] = part;
    verdict.is_open[p] = on_two_walls(parts.set(), parts.sites(), part, noise, given.of_sites.unrest) ? 0 : 1;
    verdict.is_doubtful[p] = verdict.is_open[p] == 0 && given.unrest[p] > kUnrest ? 1 : 0;
  }
  return verdict;
}

// The best hypothesis of every part. Where unrest alone does not decide it has to be shown to be better than what was given, where that is
// restless; else nothing is certain, if the part is not at rest either.
void choose_hypotheses(const SiteParts& parts, const std::vector<std::vector<Vec3>>& tried, const Given& given, double noise,
                       Verdict& verdict) {
  JumpDefects defects = parts.jump_defects(tried);
  std::vector<double> least(parts.count(), HUGE_VAL);
  for (std::size_t h = 0; h < tried.size(); ++h) {
    const std::vector<double> all = parts.means(defects.all[h]);
    const std::vector<double> own = parts.means(defects.own[h]);
    for (std::size_t p = 0; p < all.size(); ++p) {
      if (all[p] + own[p] >= least[p]) continue;
      least[p] = all[p] + own[p];
      verdict.defect[p] = all[p];
      verdict.best[p] = h;
    }
  }
  verdict.defects = std::move(defects.all);
  for (std::size_t h = 0; h < tried.size(); ++h) {
    const std::vector<Vec3> normals = at_sites(parts.sites(), tried[h]);
    for (std::uint32_t p = 0; p < parts.count(); ++p) {
      if (verdict.is_open[p] != 0 && verdict.best[p] == h) verdict.enclosure[p] = parts.enclosure(parts.members(p), normals);
    }
  }
  const double most_unrest = unrest_of_open(parts.thinned_for_noise());
  for (std::size_t p = 0; p < parts.count(); ++p) {
    if (verdict.is_open[p] == 0) continue;
    const std::vector<std::uint32_t>& restless = verdict.restless[p];
    const double defect = mean_over(restless, verdict.defects[verdict.best[p]]);
    const double given_defect = mean_over(restless, given.of_sites.jump_defect);
    const bool is_shown = is_shown_better(defect, given_defect);
    const bool is_better = given.unrest[p] > most_unrest || is_shown;
    // Noise makes one wall of two: what encloses most of all directions, as no bowl up to a half sphere does, is a closed surface whose
    // thin parts it hides. So is what is at rest but for a place.
    const bool in_pieces = restless.size() < parts.members(p).size();
    const bool is_enclosed = (noise > 0 || in_pieces) && std::abs(verdict.enclosure[p]) >= kMostOf;
    if (is_better && !is_enclosed) continue;
    verdict.is_open[p] = 0;
    verdict.is_doubtful[p] = given.unrest[p] > kUnrest ? 1 : 0;
    // What encloses little has no outside that tells which way to turn it.
    const bool has_outside = std::abs(verdict.enclosure[p]) >= kMostOf;
    verdict.is_turned[p] = has_outside && (is_shown || (verdict.is_doubtful[p] != 0 && defect < given_defect)) ? 1 : 0;
  }
}

// Of every point, the normal that the best hypothesis of its part has.
std::vector<Vec3> best_of(const SiteParts& parts, const std::vector<std::vector<Vec3>>& tried, const Verdict& verdict) {
  std::vector<Vec3> best(parts.set().size());
  for (std::size_t i = 0; i < best.size(); ++i) best[i] = tried[verdict.best[parts.of_point(i)]][i];
  return best;
}

// Turns the points of closed parts that are restless to the sides of the best hypothesis, but where points of both sides are mixed: those
// may be on two walls. Patches that are turned the other way are not, but at their rims, which they are no longer once the patches are
// turned.
void turn_restless(const SiteParts& parts, const std::vector<Vec3>& best, const Verdict& verdict, std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> is_turning(parts.sites().size(), 0);
  for (std::size_t p = 0; p < parts.count(); ++p) {
    if (verdict.is_turned[p] == 0) continue;
    for (const std::uint32_t s : verdict.restless[p]) is_turning[s] = 1;
  }
  for (bool is_turned = true; is_turned;) {
    is_turned = false;
    const std::vector<double> one_way = concentration(parts.sites(), normals);
    for (std::uint32_t i = 0; i < normals.size(); ++i) {
      const std::uint32_t s = parts.sites().site_of[i];
      if (is_turning[s] == 0 || one_way[s] < kSameSide) continue;
      if (dot(normals[i], best[i]) * verdict.enclosure[parts.of_point(i)] >= 0) continue;
      normals[i] = vector::scale(normals[i], -1);
      is_turned = true;
    }
  }
}

// What is known of the points, whose normals become on open parts those of `best`, of the best hypotheses, or where these do not jump those
// of `wide`, as seen from afar; whichever way they face.
OpenSurfaces with_open_parts(const SiteParts& parts, const std::vector<Vec3>& best, const std::vector<Vec3>& wide, const Verdict& verdict,
                             std::vector<float> certified, std::vector<Vec3>& normals) {
  OpenSurfaces found;
  found.certified = std::move(certified);
  found.resize(normals.size());
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = parts.of_point(i);
    if (verdict.is_doubtful[p] != 0) found.certainty[i] = kUndecided;
    if (verdict.is_open[p] == 0) continue;
    found.agrees[i] = verdict.defect[p] < kUndecided ? 1 : 0;
    const double agreed = 1 - verdict.defects[verdict.best[p]][parts.sites().site_of[i]];
    // A side that shows less than half of the jump has more against it than for it, and what is around tells.
    normals[i] = agreed < kUndecided ? wide[i] : best[i];
    found.certified[i] = static_cast<float>(std::clamp(agreed / kUndecided, 0.0, 1.0));
  }
  return found;
}

// The points of marked parts, ascending.
std::vector<std::uint32_t> points_of(const SiteParts& parts, const std::vector<std::uint8_t>& marked) {
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < parts.sites().site_of.size(); ++i) {
    if (marked[parts.of_point(i)] != 0) some.push_back(i);
  }
  return some;
}

}  // namespace

void OpenSurfaces::resize(std::size_t points) {
  part.resize(points, kNone);
  certainty.resize(points, 1);
  agrees.resize(points, 0);
  held.resize(points, 1);
}

void OpenSurfaces::put(const std::vector<std::uint32_t>& some, const OpenSurfaces& here) {
  is_turned = is_turned || here.is_turned;
  if (part.empty() && !here.part.empty()) resize(certified.size());
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    certified[i] = here.certified[k];
    if (part.empty()) continue;
    part[i] = here.is_open(k) ? some[here.part[k]] : kNone;
    certainty[i] = here.part.empty() ? 1 : here.certainty[k];
    agrees[i] = here.part.empty() ? 0 : here.agrees[k];
    held[i] = here.part.empty() ? 1 : here.held[k];
  }
}

bool is_unsure(const OpenSurfaces& surfaces, const std::vector<float>& confidence, std::size_t i) {
  const bool not_shown = !surfaces.is_open(i) && confidence[i] <= kUndecided && confidence.size() >= kFewestSites;
  return confidence[i] < kUndecided || not_shown;
}

double unsure_share(const OpenSurfaces& surfaces, const std::vector<float>& confidence) {
  std::size_t unsure = 0;
  for (std::size_t i = 0; i < confidence.size(); ++i) unsure += is_unsure(surfaces, confidence, i) ? 1 : 0;
  return static_cast<double>(unsure) / static_cast<double>(confidence.size());
}

OpenSurfaces find_open_surfaces(const PointSet& set, double noise, const SumPlan& sums, std::vector<Vec3>& normals,
                                const std::atomic<bool>* cancel) {
  if (set.size() < kFewestSites) {  // no side can be certified
    OpenSurfaces unknown;
    unknown.certified.assign(set.size(), 0);
    return unknown;
  }
  const SiteParts parts(set, noise, sums, cancel);
  Given given{parts.test(normals), {}, {}};
  given.unrest = parts.means(given.of_sites.unrest);
  given.defect = parts.means(given.of_sites.jump_defect);
  Verdict verdict = suspected_parts(parts, given, noise);
  const std::vector<std::uint32_t> suspects = points_of(parts, verdict.is_open);
  const bool are_some = !suspects.empty() && suspects.size() < set.size();
  if (are_some) std::fill(verdict.is_open.begin(), verdict.is_open.end(), std::uint8_t{0});
  std::vector<Vec3> best;
  if (is_any_marked(verdict.is_open)) {
    const std::vector<std::vector<Vec3>> tried = sides_by_agreement(set, parts.sites(), sums, cancel);
    choose_hypotheses(parts, tried, given, noise, verdict);
    best = best_of(parts, tried, verdict);
  }
  const bool are_turned = is_any_marked(verdict.is_turned);
  if (are_turned) turn_restless(parts, best, verdict, normals);
  std::vector<float> shown = certified_sides(parts, are_turned ? parts.test(normals) : given.of_sites, normals, noise == 0);
  given = {};  // the graph of the outside wants its memory, and that of the hypotheses
  OpenSurfaces found;
  if (is_any_marked(verdict.is_open) || is_any_marked(verdict.is_doubtful)) {
    std::vector<Vec3> wide = best.empty() ? best : seen_from_afar(set, parts.sites(), best, sums, cancel);
    found = with_open_parts(parts, best, wide, verdict, std::move(shown), normals);
    std::vector<Vec3>().swap(best);
    std::vector<Vec3>().swap(wide);
    std::vector<std::vector<double>>().swap(verdict.defects);
    if (is_any_marked(verdict.is_open)) face_outside(parts, verdict.is_open, verdict.enclosure, normals, found);
  } else {
    found.certified = std::move(shown);
  }
  found.uncertified = noise == 0 ? kUndecided : 0;
  found.is_turned = are_turned;
  if (!are_some) return found;
  std::vector<Vec3> sides = values_at(suspects, normals);  // of the suspects without the others, which are closed
  found.put(suspects, find_open_surfaces(PointSet(values_at(suspects, set.points())), noise, sums, sides, cancel));
  for (std::size_t k = 0; k < suspects.size(); ++k) normals[suspects[k]] = sides[k];
  return found;
}

}  // namespace g3r

#include "invariants.h"

#include <g3r/g3r.h>
#include <g3r/io.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "run_options.h"
#include "sanitized.h"
#include "shapes.h"

namespace g3r::stress {
namespace {

constexpr float kSure = 0.9F;
constexpr double kFewWrong = 0.003;     // share of wrong and sure points that is honest, and at least
constexpr double kFewPoints = 1;        // this many
constexpr std::size_t kNeighbours = 8;  // that tell the spacing of a place
constexpr double kThinSpacings = 1.5;   // as bench/inputs.h has it
constexpr double kThinDeviations = 4;
constexpr double kOpposed = -0.5;     // cosine: more than 120 degrees
constexpr double kUnit = 1e-6;        // of the length of normals
constexpr double kMemorySlack = 4e6;  // bytes: pages of code and of the allocator that come in with the first run
constexpr double kLineRatio = 1e-9;   // extent across over extent along, below which points are on a line
constexpr double kSliver = 0.05;      // the same of up to kNeighbours points, below which their surface is no triangle
constexpr double kMoved = 0.01;       // spacings: rounding by more makes another cloud
// Words of warnings that say nothing of sides: of points that are none, of hints, and of what options make of the mesh.
constexpr const char* kNotOfSides[] = {"non-finite",          "hint", "nothing was trimmed", "trimmed at", "so few triangles",
                                       "triangles instead of"};

class Judge {
 public:
  explicit Judge(Outcome& outcome) : outcome_(outcome) {}
  void demand(bool holds, const char* kind, const std::string& what) {
    if (!holds && seen_.insert(kind).second) outcome_.findings.push_back({kind, what});
  }

 private:
  Outcome& outcome_;
  std::set<std::string> seen_;
};

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// A line of /proc/self/status, in bytes.
double status_bytes(const std::string& name) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024 * std::strtod(line.c_str() + name.size() + 1, nullptr);
  }
  return 0;
}

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double norm(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }
bool is_finite(const Vec3& a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }

// Fewer than 4 distinct places, or all on a line, which the program has to refuse, or a sliver, whose surface is below one triangle.
bool may_be_no_cloud(const std::vector<Vec3>& points) {
  std::set<Vec3> places;
  for (const Vec3& p : points) {
    if (is_finite(p)) places.insert(p);
  }
  if (places.size() < 4) return true;
  const Vec3 from = *places.begin();
  Vec3 along{};
  for (const Vec3& p : places) {
    if (norm(minus(p, from)) > norm(along)) along = minus(p, from);
  }
  double across = 0;
  for (const Vec3& p : places) across = std::max(across, norm(cross(along, minus(p, from))) / norm(along));
  return across <= (places.size() <= kNeighbours ? kSliver : kLineRatio) * norm(along);
}

// Besides: what has no surface, what is smaller than a cell of the mesh because a far point makes cells of a given depth so large, and what
// an earlier method says of few points, which need not enclose anything.
bool may_be_refused(const Case& tested) {
  if (tested.recipe.has("far") && tested.recipe.has("depth")) return true;
  if (tested.recipe.has("method")) return true;
  return tested.scene.sides == Sides::kNone || may_be_no_cloud(tested.scene.points);
}

void check_numbers(const std::vector<Vec3>& points, const Orientation& o, Judge& judge) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string place = " of point " + std::to_string(i);
    const double size = norm(o.normals[i]);
    judge.demand(is_finite(points[i]) ? std::abs(size - 1) < kUnit : size == 0, "number",
                 "the normal" + place + " has length " + std::to_string(size));
    judge.demand(std::isfinite(o.areas[i]) && o.areas[i] >= 0, "number", "the area" + place + " is " + std::to_string(o.areas[i]));
    judge.demand(o.confidence[i] >= 0 && o.confidence[i] <= 1, "number",
                 "the confidence" + place + " is " + std::to_string(o.confidence[i]));
  }
  const Stats& s = o.stats;
  for (const double v :
       {s.box_side, s.spacing, s.noise, s.epsilon, s.open_share, s.undecided_share, s.confidence_mean, s.confidence_below_half}) {
    judge.demand(std::isfinite(v) && v >= 0, "number", "a figure of the report is " + std::to_string(v));
  }
}

Mesh welded(const Mesh& mesh) {
  std::map<Vec3, std::uint32_t> places;
  Mesh out;
  std::vector<std::uint32_t> to;
  for (const Vec3& p : mesh.vertices) {
    const auto [found, fresh] = places.emplace(p, static_cast<std::uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back(p);
    to.push_back(found->second);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    if (to[a] != to[b] && to[b] != to[c] && to[c] != to[a]) out.triangles.push_back({to[a], to[b], to[c]});
  }
  return out;
}

// Edges with more triangles one way than the other: there the surface ends.
std::size_t ends_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k];
      const std::uint32_t to = t[(k + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  return static_cast<std::size_t>(std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

void check_surface(const Reconstruction& r, bool trimmed, Outcome& outcome, Judge& judge) {
  const auto lost = std::find_if_not(r.mesh.vertices.begin(), r.mesh.vertices.end(), is_finite);
  if (lost != r.mesh.vertices.end()) {
    return judge.demand(false, "mesh", "vertex " + std::to_string(lost - r.mesh.vertices.begin()) + " has a coordinate that is not finite");
  }
  const std::vector<float>& confidence = r.mesh.confidence;
  const bool is_share = std::all_of(confidence.begin(), confidence.end(), [](float c) { return c >= 0 && c <= 1; });
  judge.demand(is_share && confidence.size() == r.mesh.vertices.size(), "number", "not every vertex has a confidence in [0, 1]");
  const MeshCheck check = check_mesh(r.mesh);
  judge.demand(check.triangles > 0 || trimmed, "mesh", "the mesh is empty");
  judge.demand(check.manifold, "mesh",
               "not manifold: " + std::to_string(check.nonmanifold_edges) + " edges, " + std::to_string(check.nonmanifold_vertices) +
                   " vertices of " + std::to_string(check.triangles) + " triangles");
  judge.demand(check.closed || trimmed, "mesh", "not closed: " + std::to_string(check.boundary_edges) + " edges at its end");
  const Mesh seam = welded(r.mesh);
  outcome.touches = !check_mesh(seam).manifold;
  const std::size_t ends = trimmed ? 0 : ends_of(seam);
  judge.demand(ends == 0, "weld", "after welding the surface ends at " + std::to_string(ends) + " edges");
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

std::string difference(const Reconstruction& a, const Reconstruction& b) {
  std::string out;
  if (!same_bytes(a.orientation.normals, b.orientation.normals)) out += " normals";
  if (!same_bytes(a.orientation.areas, b.orientation.areas)) out += " areas";
  if (!same_bytes(a.orientation.confidence, b.orientation.confidence)) out += " confidence";
  if (!same_bytes(a.mesh.vertices, b.mesh.vertices)) out += " vertices";
  if (!same_bytes(a.mesh.triangles, b.mesh.triangles)) out += " triangles";
  if (!same_bytes(a.mesh.confidence, b.mesh.confidence)) out += " confidence of vertices";
  if (a.orientation.stats.warnings != b.orientation.stats.warnings) out += " warnings";
  return out;
}

std::vector<std::size_t> random_order(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  return order;
}

template <typename T>
std::vector<T> put_back(const std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[order[i]] = values[i];
  return out;
}

void check_order(const Case& tested, const RunOptions& run, const Reconstruction& first, Judge& judge) {
  const std::vector<std::size_t> order = random_order(tested.scene.points.size(), 5);
  std::vector<Vec3> points;
  points.reserve(order.size());
  for (const std::size_t i : order) points.push_back(tested.scene.points[i]);
  Reconstruction again = reconstruct(points, run.options, run.mesh);
  Orientation& o = again.orientation;
  o.normals = put_back(o.normals, order);
  o.areas = put_back(o.areas, order);
  o.confidence = put_back(o.confidence, order);
  const std::string differ = difference(first, again);
  judge.demand(differ.empty(), "order", "another order of the points changes" + differ);
}

// Turned about the origin by a rotation that mixes all axes.
struct Turn {
  Vec3 x{0.36, 0.48, -0.8};
  Vec3 y{-0.8, 0.6, 0};
  Vec3 z{0.48, 0.64, 0.6};
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return {dot(x, p), dot(y, p), dot(z, p)}; }
};

// How far apart numbers of this size are, in double precision or in single.
double rounding(const std::vector<Vec3>& points, bool single) {
  double largest = 0;
  for (const Vec3& p : points) largest = is_finite(p) ? std::max(largest, norm(p)) : largest;
  return largest * (single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon());
}

// Open surfaces may face either way: what counts is whether sure points agree with the first run, or all of them disagree.
void check_rigid(const Case& tested, const RunOptions& run, const Reconstruction& first, Judge& judge) {
  if (rounding(tested.scene.points, false) > kMoved * first.orientation.stats.spacing) return;
  const Turn turn;
  std::vector<Vec3> points(tested.scene.points.size());
  std::transform(tested.scene.points.begin(), tested.scene.points.end(), points.begin(), turn);
  Options turned = run.options;
  Hints& hints = turned.hints;
  if (hints.up) hints.up = turn(*hints.up);
  for (Vec3& p : hints.sensors) p = turn(p);
  for (Vec3& p : hints.inside) p = turn(p);
  const Orientation other = orient(points, turned);
  std::set<Vec3> sure, turned_over;  // places: points at the same place have one side
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (first.orientation.confidence[i] <= kSure || other.confidence[i] <= kSure) continue;
    sure.insert(points[i]);
    if (dot(turn(first.orientation.normals[i]), other.normals[i]) < 0) turned_over.insert(points[i]);
  }
  const double allowed = std::max(kFewPoints, kFewWrong * static_cast<double>(points.size()));
  judge.demand(static_cast<double>(turned_over.size()) <= allowed, "rigid",
               std::to_string(turned_over.size()) + " of " + std::to_string(sure.size()) +
                   " places that are sure before and after change their side");
}

bool warns_of_sides(const Stats& stats) {
  if (!stats.consistent || !stats.converged) return true;
  return std::any_of(stats.warnings.begin(), stats.warnings.end(), [](const std::string& warning) {
    return std::none_of(std::begin(kNotOfSides), std::end(kNotOfSides),
                        [&](const char* words) { return warning.find(words) != std::string::npos; });
  });
}

// Whether another side of the surface is too near for the samples, or the noise, to distinguish them: docs/glossary.md, "thin".
bool is_thin(const Scene& scene, std::size_t point, double deviation) {
  std::vector<double> squared;
  for (const Vec3& p : scene.points) {
    const Vec3 d = minus(p, scene.points[point]);
    if (is_finite(p)) squared.push_back(dot(d, d));
  }
  const std::size_t rank = std::min(kNeighbours, squared.size() - 1);
  std::nth_element(squared.begin(), squared.begin() + static_cast<std::ptrdiff_t>(rank), squared.end());
  const double spacing = std::sqrt(std::numbers::pi * squared[rank] / static_cast<double>(rank));
  const double reach = std::max(kThinSpacings * spacing, kThinDeviations * deviation);
  for (std::size_t j = 0; j < scene.points.size(); ++j) {
    const Vec3 d = minus(scene.points[j], scene.points[point]);
    if (dot(d, d) < reach * reach && dot(scene.truth[j], scene.truth[point]) < kOpposed) return true;
  }
  return false;
}

// Points that face the wrong side, and those of them that are sure.
struct WrongSides {
  double known = 0;
  double all = 0;
  std::vector<std::size_t> sure;
};

WrongSides wrong_sides(const Scene& scene, const Orientation& o, double sign) {
  WrongSides out;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.truth[i] == Vec3{0, 0, 0}) continue;
    out.known += 1;
    if (sign * dot(scene.truth[i], o.normals[i]) >= 0) continue;
    out.all += 1;
    if (o.confidence[i] > kSure) out.sure.push_back(i);
  }
  return out;
}

void check_confidence(const Case& tested, const Orientation& o, Outcome& outcome, Judge& judge) {
  const Scene& scene = tested.scene;
  outcome.warned = warns_of_sides(o.stats);
  const bool turned_by_hints = tested.recipe.has("sensor") || tested.recipe.has("seen_from_inside") || tested.recipe.has("inside");
  if (scene.sides == Sides::kNone || turned_by_hints) return;
  const double sign = tested.recipe.has("flip") ? -1 : 1;
  WrongSides wrong = wrong_sides(scene, o, sign);
  if (wrong.known == 0) return;
  if (scene.sides == Sides::kEither && 2 * wrong.all > wrong.known) wrong = wrong_sides(scene, o, -sign);
  const auto sure = static_cast<double>(wrong.sure.size());
  outcome.wrong = wrong.all / wrong.known;
  outcome.wrong_and_sure = sure / wrong.known;
  if (outcome.warned || has_other_method(tested.recipe) || sure <= std::max(kFewPoints, kFewWrong * wrong.known)) return;
  const double steps = std::hypot(tested.recipe.number("step") * o.stats.spacing, rounding(scene.points, tested.recipe.has("float32")));
  const double deviation = std::hypot(tested.recipe.number("noise") * o.stats.spacing, steps / std::sqrt(12.0));
  const auto thin = std::count_if(wrong.sure.begin(), wrong.sure.end(), [&](std::size_t i) { return is_thin(scene, i, deviation); });
  judge.demand(false, 2 * static_cast<double>(thin) > sure ? "thin" : "confidence",
               std::to_string(wrong.sure.size()) + " of " + std::to_string(static_cast<int>(wrong.known)) +
                   " points are wrong and sure, without a warning; wrong: " + std::to_string(static_cast<int>(wrong.all)) +
                   ", near another side: " + std::to_string(thin));
}

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "g3r-stress-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw IoError(IoError::Kind::kCannotCreate, "no folder for files: " + name);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string at(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

int run_program(std::vector<std::string> words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& w : words) arguments.push_back(w.data());
  arguments.push_back(nullptr);
  const unsigned left = alarm(0);  // of this process, in seconds; 0: no limit
  alarm(left);
  const pid_t child = fork();
  if (child == 0) {
    alarm(left > 1 ? left - 1 : left);  // goes on in the program
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// Through a file of doubles and back.
void check_program(const Case& tested, const std::string& program, const Orientation& first, Judge& judge) {
  const Folder folder;
  Cloud cloud;
  cloud.positions = tested.scene.points;
  write_cloud(folder.at("in.ply"), cloud, nullptr, nullptr);
  std::vector<std::string> words{program, folder.at("in.ply"), folder.at("mesh.ply"), "-q", "--oriented", folder.at("out.ply")};
  const std::vector<std::string> options = command_line_options(tested);
  words.insert(words.end(), options.begin(), options.end());
  const int code = run_program(words);
  judge.demand(code == 0, "program", "g3r ends with " + std::to_string(code));
  if (code != 0) return;
  const std::string differ = difference_in_file(read_cloud(folder.at("out.ply")), first);
  judge.demand(differ.empty(), "program", differ);
}

// What one result has to be by itself. False if it has not as many values as points.
bool judge_result(const Case& tested, const Reconstruction& result, bool statistical, Outcome& outcome, Judge& judge) {
  const Orientation& o = result.orientation;
  const std::size_t points = tested.scene.points.size();
  const bool complete = o.normals.size() == points && o.areas.size() == points && o.confidence.size() == points;
  judge.demand(complete, "number", "the result has not as many values as points");
  if (!complete) return false;
  check_numbers(tested.scene.points, o, judge);
  check_surface(result, run_options(tested).mesh.trim != MeshOptions::Trim::kOff, outcome, judge);
  if (statistical) check_confidence(tested, o, outcome, judge);
  return true;
}

// The run that all others are compared with. Empty if the cloud is refused.
std::optional<Reconstruction> first_run(const Case& tested, const RunOptions& run, Outcome& outcome, Judge& judge) {
  const double resident = status_bytes("VmRSS");
  const double start = cpu_seconds();
  try {
    Reconstruction first = reconstruct(tested.scene.points, run.options, run.mesh);
    outcome.cpu_seconds = cpu_seconds() - start;
    const double taken = status_bytes("VmHWM") - resident;
    const auto plan = static_cast<double>(first.orientation.stats.planned_memory_bytes);
    judge.demand(kSanitized || taken <= plan + kMemorySlack, "memory",
                 "took " + std::to_string(taken / 1e6) + " MB, planned " + std::to_string(plan / 1e6));
    return first;
  } catch (const InvalidInput& error) {
    outcome.refused = true;
    judge.demand(may_be_refused(tested), "refused", error.what());
  }
  return std::nullopt;
}

}  // namespace

Outcome hold_result(const Case& tested, const Reconstruction& result, bool statistical) {
  Outcome outcome;
  Judge judge(outcome);
  judge_result(tested, result, statistical, outcome, judge);
  return outcome;
}

std::string difference_in_file(const Cloud& written, const Orientation& result) {
  if (written.normals.size() != result.normals.size() || written.confidence.size() != result.confidence.size())
    return "the program writes " + std::to_string(written.normals.size()) + " normals and " + std::to_string(written.confidence.size()) +
           " confidences";
  for (std::size_t i = 0; i < result.normals.size(); ++i) {
    const double apart = norm(minus(written.normals[i], result.normals[i]));
    if (!(apart < kUnit)) return "normal " + std::to_string(i) + " of the program differs by " + std::to_string(apart);
    if (written.confidence[i] != result.confidence[i]) return "the program is another time as sure of point " + std::to_string(i);
  }
  return "";
}

bool is_statistical(const std::string& kind) { return kind == "rigid" || kind == "confidence" || kind == "thin"; }

Outcome hold(const Case& tested, const Demands& demands) {
  Outcome outcome;
  Judge judge(outcome);
  RunOptions run = run_options(tested);
  run.options.threads = 1;
  const std::optional<Reconstruction> first = first_run(tested, run, outcome, judge);
  if (!first || !judge_result(tested, *first, demands.statistical, outcome, judge)) return outcome;
  const bool all = tested.scene.points.size() <= demands.thorough_points;
  const auto turn = static_cast<std::uint64_t>(tested.recipe.number("seed")) % 3;  // which of the repeated runs a large cloud gets
  run.options.threads = 2;
  if (all || turn == 0) {
    const std::string differ = difference(*first, reconstruct(tested.scene.points, run.options, run.mesh));
    judge.demand(differ.empty(), "threads", "two threads instead of one change" + differ);
  }
  if (all || turn == 1) check_order(tested, run, *first, judge);
  if (demands.statistical && !has_other_method(tested.recipe) && (all || turn == 2)) check_rigid(tested, run, *first, judge);
  if (!demands.program.empty()) check_program(tested, demands.program, first->orientation, judge);
  return outcome;
}

}  // namespace g3r::stress

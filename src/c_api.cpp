// The C interface: pointers into views, exceptions into status codes.
#include <g3r/g3r.h>
#include <g3r/g3r_c.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <vector>

namespace {

std::string& last_error() {
  thread_local std::string text;
  return text;
}

std::string& last_report() {
  thread_local std::string text;
  return text;
}

g3r_status fail(g3r_status status, const char* what) noexcept {
  try {
    last_error() = what;
  } catch (...) {  // no memory for the text: the status alone must do
    last_error().clear();
  }
  return status;
}

template <class Work>
g3r_status guarded(const Work& work) noexcept {
  try {
    work();
    return G3R_OK;
  } catch (const g3r::InvalidInput& error) {
    return fail(G3R_INVALID_INPUT, error.what());
  } catch (const g3r::Unavailable& error) {
    return fail(G3R_UNAVAILABLE, error.what());
  } catch (const g3r::Cancelled& error) {
    return fail(G3R_CANCELLED, error.what());
  } catch (const g3r::IoError& error) {
    return fail(G3R_IO_ERROR, error.what());
  } catch (const std::bad_alloc&) {
    return fail(G3R_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return fail(G3R_INTERNAL_ERROR, error.what());
  } catch (...) {
    return fail(G3R_INTERNAL_ERROR, "an unknown error");
  }
}

struct Request {
  g3r::Options options;
  g3r::MeshOptions mesh_options;
  g3r::Monitor monitor;
};

g3r::Length read_length(double value, g3r_unit unit, const std::string& name) {
  using Unit = g3r::Length::Unit;
  constexpr Unit kUnits[] = {Unit::kAuto, Unit::kInput, Unit::kPercent, Unit::kSpacing};
  if (unit < G3R_UNIT_AUTO || unit > G3R_UNIT_SPACING) throw g3r::InvalidInput(name + "_unit is not a g3r_unit");
  if (unit == G3R_UNIT_AUTO && value != 0) throw g3r::InvalidInput(name + " is given without its unit: set " + name + "_unit");
  return {kUnits[unit], value};
}

std::vector<g3r::Vec3> read_places(const double* from, size_t count, const char* name) {
  if (from == nullptr && count > 0) throw g3r::InvalidInput(std::string(name) + " must not be NULL");
  std::vector<g3r::Vec3> places(count);
  for (size_t i = 0; i < count; ++i) places[i] = {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
  return places;
}

g3r::Hints read_hints(const g3r_options& o, size_t points) {
  g3r::Hints hints;
  if (o.up != nullptr) hints.up = g3r::Vec3{o.up[0], o.up[1], o.up[2]};
  hints.sensors = read_places(o.sensors, o.sensor_count, "sensors");
  if (o.sensor_of_point != nullptr) hints.sensor_of_point.assign(o.sensor_of_point, o.sensor_of_point + points);
  hints.inside = read_places(o.inside, o.inside_count, "inside");
  hints.seen_from_inside = o.seen_from_inside != 0;
  hints.flip = o.flip != 0;
  return hints;
}

Request read_options(const g3r_options* given, size_t points) {
  g3r_options o;
  g3r_options_init(&o, sizeof o);
  if (given != nullptr) {
    if (given->size < sizeof given->size) throw g3r::InvalidInput("the options were not initialised with g3r_options_init()");
    std::memcpy(&o, given, std::min(given->size, sizeof o));  // an older caller leaves the newer members at their defaults
  }
  Request request;
  request.options.preset = o.paper != 0 ? g3r::Preset::kPaper : g3r::Preset::kDefault;
  request.options.epsilon = read_length(o.epsilon, o.epsilon_unit, "epsilon");
  request.options.noise = read_length(o.noise, o.noise_unit, "noise");
  request.options.degree = o.degree;
  request.options.threads = o.threads;
  request.options.max_memory = static_cast<size_t>(std::min<uint64_t>(o.max_memory, std::numeric_limits<size_t>::max()));
  request.options.hints = read_hints(o, points);
  request.mesh_options.depth = o.depth;
  if (o.device != nullptr) request.options.device = o.device;
  if (o.progress != nullptr) {
    request.monitor.progress = [o](std::string_view stage, double fraction) {
      return o.progress(o.user, std::string(stage).c_str(), fraction) != 0;
    };
  }
  return request;
}

void give(const g3r::Orientation& from, double* normals, double* areas, float* confidence) {
  if (normals != nullptr) {
    for (const g3r::Vec3& n : from.normals) normals = std::copy(n.begin(), n.end(), normals);
  }
  if (areas != nullptr) std::copy(from.areas.begin(), from.areas.end(), areas);
  if (confidence != nullptr) std::copy(from.confidence.begin(), from.confidence.end(), confidence);
}

// What a g3r_mesh points into; the C struct comes first so that one pointer frees both.
struct OwnedMesh {
  g3r_mesh view;
  g3r::Mesh mesh;
};

std::string read_path(const char* path, const char* name) {
  if (path == nullptr) throw g3r::InvalidInput(std::string(name) + " must not be NULL");
  return path;
}

void require_size(const g3r_tiles_info* info) {
  if (info != nullptr && info->size < sizeof info->size) throw g3r::InvalidInput("the size of the g3r_tiles_info is not set");
}

void give(const g3r::TileStatus& from, g3r_tiles_info* info) {
  if (info == nullptr) return;
  g3r_tiles_info all{};
  all.size = info->size;
  all.points = from.points;
  all.non_finite = from.non_finite;
  all.tiles = from.tiles;
  all.done = from.done;
  all.coarse_points = from.coarse_points;
  all.largest_tile = from.largest_tile;
  all.worker_memory_bytes = from.worker_memory_bytes;
  all.disk_bytes = from.disk_bytes;
  all.work = from.work;
  all.open_share = from.open_share;
  all.undecided_share = from.undecided_share;
  all.converged = from.converged ? 1 : 0;
  all.consistent = from.consistent ? 1 : 0;
  all.doubtful = from.doubtful ? 1 : 0;
  std::memcpy(info, &all, std::min(info->size, sizeof all));
}

}  // namespace

extern "C" {

void g3r_options_init(g3r_options* options, size_t size) {
  g3r_options defaults{};
  defaults.size = size;
  defaults.degree = -1;
  std::memcpy(options, &defaults, std::min(size, sizeof defaults));
}

g3r_status g3r_orient(const double* points, size_t count, const g3r_options* options, double* normals, double* areas, float* confidence) {
  return guarded([&] {
    if ((points == nullptr && count > 0) || normals == nullptr) throw g3r::InvalidInput("points and normals must not be NULL");
    const Request request = read_options(options, count);
    const g3r::Orientation result = g3r::orient(g3r::PointsView(points, count), request.options, request.monitor);
    last_report() = g3r::report_json(result.stats);
    give(result, normals, areas, confidence);
  });
}

g3r_status g3r_reconstruct(const double* points, size_t count, const g3r_options* options, double* normals, double* areas,
                           float* confidence, g3r_mesh** mesh) {
  return guarded([&] {
    if ((points == nullptr && count > 0) || mesh == nullptr) throw g3r::InvalidInput("points and mesh must not be NULL");
    const Request request = read_options(options, count);
    g3r::Reconstruction result = g3r::reconstruct(g3r::PointsView(points, count), request.options, request.mesh_options, request.monitor);
    auto owned = std::make_unique<OwnedMesh>(OwnedMesh{{}, std::move(result.mesh)});
    owned->view = {owned->mesh.vertices.size(), owned->mesh.triangles.size(),
                   owned->mesh.vertices.empty() ? nullptr : owned->mesh.vertices[0].data(),
                   owned->mesh.triangles.empty() ? nullptr : owned->mesh.triangles[0].data()};
    last_report() = g3r::report_json(result.orientation.stats, &result.check);
    give(result.orientation, normals, areas, confidence);
    *mesh = &owned.release()->view;
  });
}

g3r_status g3r_tiles_plan(const char* const* inputs, size_t input_count, const char* folder, size_t tiles, const g3r_options* options,
                          g3r_tiles_info* info) {
  return guarded([&] {
    require_size(info);
    if (inputs == nullptr && input_count > 0) throw g3r::InvalidInput("inputs must not be NULL");
    const Request request = read_options(options, 1);  // of sensor_of_point one is enough to be refused
    std::vector<std::string> paths;
    for (size_t i = 0; i < input_count; ++i) paths.push_back(read_path(inputs[i], "an input"));
    const g3r::Options& o = request.options;
    const g3r::TileOptions plan{o.max_memory, tiles, o.hints, o.threads, o.device};
    give(g3r::plan_tiles(paths, read_path(folder, "folder"), plan, request.monitor), info);
  });
}

g3r_status g3r_tiles_run(const char* folder, size_t worker, size_t workers, const g3r_options* options, g3r_tiles_info* info) {
  return guarded([&] {
    require_size(info);
    const Request request = read_options(options, 0);
    const g3r::TileWorker which{worker, workers, request.options.threads, request.options.device};
    give(g3r::run_tiles(read_path(folder, "folder"), which, request.monitor), info);
  });
}

g3r_status g3r_tiles_status(const char* folder, g3r_tiles_info* info) {
  return guarded([&] {
    require_size(info);
    give(g3r::tiles_status(read_path(folder, "folder")), info);
  });
}

g3r_status g3r_tiles_merge(const char* folder, const char* output, const g3r_options* options) {
  return guarded([&] {
    const Request request = read_options(options, 0);
    (void)g3r::merge_tiles(read_path(folder, "folder"), read_path(output, "output"), request.monitor);
  });
}

void g3r_mesh_free(g3r_mesh* mesh) { delete reinterpret_cast<OwnedMesh*>(mesh); }

const char* g3r_status_text(g3r_status status) {
  switch (status) {
    case G3R_OK:
      return "ok";
    case G3R_INVALID_INPUT:
      return "the data or an option cannot be used";
    case G3R_UNAVAILABLE:
      return "this build or this machine cannot serve the request";
    case G3R_CANCELLED:
      return "cancelled";
    case G3R_OUT_OF_MEMORY:
      return "out of memory";
    case G3R_INTERNAL_ERROR:
      return "an error in g3r";
    case G3R_IO_ERROR:
      return "a file cannot be created, read or written";
  }
  return "not a status of g3r";
}

const char* g3r_last_report(void) { return last_report().c_str(); }

const char* g3r_last_error(void) { return last_error().c_str(); }

const char* g3r_version(void) { return g3r::version().data(); }

}  // extern "C"

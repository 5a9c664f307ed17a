// What the page's worker calls (worker.js): a cloud that lies in Emscripten's file system in, a page to look at, figures and files out.
// All functions that can fail return whether they did not; web_message() says why. One cloud at a time.
#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/view.h>

#include <cstddef>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <emscripten/emscripten.h>
#include <emscripten/heap.h>
#include <malloc.h>

// Of the worker: shows how far a step is.
EM_JS(void, show_progress, (const char* stage, double fraction), { g3rProgress(UTF8ToString(stage), fraction); });

namespace g3r {
namespace {

// Of the memory that is left the share that a plan may take: vectors that grow leave holes that are too small for their next size.
constexpr double kShare = 0.8;

constexpr const char* kOutOfMemory =
    "out of memory: a page has 4 GiB at most. Thin the cloud, leave the mesh out, or use the g3r program, which has all of the machine's";

struct Session {
  Cloud cloud;
  Orientation orientation;
  Mesh mesh;
  std::string report;
  std::string page;
};
Session session;
std::string message;
std::string warnings;  // what the file written last could not take as it is

template <class Work>
bool succeeds(const Work& work) {
  try {
    message.clear();
    work();
    return true;
  } catch (const std::bad_alloc&) {
    message = kOutOfMemory;
  } catch (const std::length_error&) {  // a vector of more than 2 GiB
    message = kOutOfMemory;
  } catch (const std::exception& error) {
    message = error.what();
  }
  return false;
}

// Bytes that the heap can still give out.
double memory_left() {
  const double used = mallinfo().uordblks;
  return static_cast<double>(emscripten_get_heap_max()) - (used < 0 ? used + 0x1p32 : used);
}

Monitor monitor() {
  Monitor shown;
  shown.progress = [](std::string_view stage, double fraction) {
    show_progress(std::string(stage).c_str(), fraction);
    return true;
  };
  return shown;
}

// The file's own name, without the folder it lies in.
std::string name_of(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

struct Request {
  std::string path;
  bool mesh = true;
  bool trim = false;  // surface far from all points
  bool limited = true;
  Up up = Up::kZ;
};

// The reader's warnings come first, as in the program's report.
void report(const MeshCheck* check = nullptr) {
  std::vector<std::string>& all = session.orientation.stats.warnings;
  all.insert(all.begin(), session.cloud.warnings.begin(), session.cloud.warnings.end());
  session.report = report_json(session.orientation.stats, check);
}

void solve(const Request& request) {
  Options options;
  options.device = "cpu";
  if (request.limited) options.max_memory = static_cast<std::size_t>(kShare * memory_left());
  const std::vector<Vec3>& points = session.cloud.positions;
  if (!request.mesh) {
    session.orientation = orient(points, options, monitor());
    report();
    return;
  }
  MeshOptions mesh_options;
  mesh_options.trim = request.trim ? MeshOptions::Trim::kAuto : MeshOptions::Trim::kOff;
  Reconstruction made = reconstruct(points, options, mesh_options, monitor());
  if (!session.cloud.colors.empty()) {
    carry_attributes(made.mesh, points, session.cloud.colors, made.orientation.confidence, {}, made.orientation.normals);
  }
  session.orientation = std::move(made.orientation);
  session.mesh = std::move(made.mesh);
  report(&made.check);
}

void show(const Request& request) {
  show_progress("draw", 0);
  Scene scene;
  scene.title = name_of(request.path);
  scene.points = session.cloud.positions;
  scene.normals = session.orientation.normals;
  scene.confidence = session.orientation.confidence;
  scene.colors = session.cloud.colors;
  scene.report = session.report;
  scene.mesh = std::move(session.mesh);  // lent: there may be no room for two
  PageOptions options;
  options.up = request.up;
  session.page = view_html(scene, options);
  session.mesh = std::move(scene.mesh);
}

void run(const Request& request) {
  session = Session{};
  show_progress("read", 0);
  session.cloud = read_cloud(request.path);
  solve(request);
  show(request);
}

void save(const std::string& path, bool mesh) {
  std::vector<std::string> lines;
  WriteOptions options;
  options.warnings = &lines;
  warnings.clear();
  if (mesh) {
    write_mesh(path, session.mesh, options);
  } else {
    write_cloud(path, session.cloud, &session.orientation.normals, &session.orientation.confidence, options);
  }
  for (const std::string& line : lines) warnings += (warnings.empty() ? "" : "; ") + line;
}

}  // namespace
}  // namespace g3r

extern "C" {

/// Reads the cloud at `path` and makes normals, mesh and page of it. Every argument but the path is 0 or 1; `limited`: refuses beforehand
/// what has no room.
EMSCRIPTEN_KEEPALIVE int web_run(const char* path, int mesh, int trim, int z_up, int limited) {
  const g3r::Request request{path, mesh != 0, trim != 0, limited != 0, z_up != 0 ? g3r::Up::kZ : g3r::Up::kY};
  return g3r::succeeds([&] { g3r::run(request); }) ? 1 : 0;
}

/// Writes the mesh, or the cloud with its normals, to `path`, in the format that its extension names.
EMSCRIPTEN_KEEPALIVE int web_save(const char* path, int mesh) {
  return g3r::succeeds([&] { g3r::save(path, mesh != 0); }) ? 1 : 0;
}

EMSCRIPTEN_KEEPALIVE const char* web_message() { return g3r::message.c_str(); }
EMSCRIPTEN_KEEPALIVE const char* web_warnings() { return g3r::warnings.c_str(); }
EMSCRIPTEN_KEEPALIVE const char* web_report() { return g3r::session.report.c_str(); }
EMSCRIPTEN_KEEPALIVE const char* web_page() { return g3r::session.page.data(); }
EMSCRIPTEN_KEEPALIVE std::size_t web_page_size() { return g3r::session.page.size(); }
}

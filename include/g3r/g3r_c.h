/* The C interface: for languages that load a shared library. Plain C99; no exception leaves a function, nothing is printed, no state is
 * shared between threads. Arrays are N x 3 doubles, row-major, and stay the caller's. Functions that return a g3r_status return G3R_OK, or
 * what went wrong, and then g3r_last_error() says it in words. See g3r.h for what they do and cost. */
#ifndef G3R_C_H
#define G3R_C_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define G3R_C_API __attribute__((visibility("default")))
#else
#define G3R_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum g3r_status {
  G3R_OK = 0,
  G3R_INVALID_INPUT = 1, /* the data or an option cannot be used */
  G3R_UNAVAILABLE = 2,   /* this build or this machine cannot serve the request */
  G3R_CANCELLED = 3,     /* the progress function returned 0 */
  G3R_OUT_OF_MEMORY = 4,
  G3R_INTERNAL_ERROR = 5, /* an error in g3r */
  G3R_IO_ERROR = 6        /* a file cannot be created, read or written */
} g3r_status;

/* Called on the calling thread with a stage and a fraction in [0, 1]; returning 0 cancels. */
typedef int (*g3r_progress)(void* user, const char* stage, double fraction);

/* Of a length. With G3R_UNIT_AUTO it is automatic and has to be 0: another number is refused, as its unit was forgotten. */
typedef enum g3r_unit { G3R_UNIT_AUTO = 0, G3R_UNIT_INPUT = 1, G3R_UNIT_PERCENT = 2, G3R_UNIT_SPACING = 3 } g3r_unit;

/* Fill with g3r_options_init() and change what you need; members are only ever added at the end. */
typedef struct g3r_options {
  size_t size;    /* of this struct, as the caller was compiled */
  int paper;      /* not 0: the published method */
  double epsilon; /* width of the mollifier, > 0 */
  g3r_unit epsilon_unit;
  int degree;          /* of the harmonic polynomials, 0..8; -1: automatic */
  int depth;           /* octree depth of the mesh, 4..12; 0: automatic */
  int threads;         /* 0: all cores; the result does not depend on it */
  uint64_t max_memory; /* bytes; 0: no limit */
  g3r_progress progress;
  void* user;   /* handed to progress */
  double noise; /* standard deviation of the points from their surface; 0: clean */
  g3r_unit noise_unit;
  /* Hints (g3r/hints.h): what you know and the points cannot say. The arrays are yours and must outlive the call. */
  const double* up;                /* 3 numbers: the direction that open surfaces face; or NULL */
  const double* sensors;           /* sensor_count x 3: places that the points were seen from; or NULL */
  const uint32_t* sensor_of_point; /* a number of a sensor for every point, G3R_NO_SENSOR for none; or NULL */
  const double* inside;            /* inside_count x 3: points inside the solid; or NULL */
  size_t sensor_count;
  size_t inside_count;
  int seen_from_inside; /* not 0: normals face the side the scanner was on, as in a room */
  int flip;             /* not 0: turn every normal */
  const char* device;   /* "auto", "cpu", "gpu", "gpu:N"; NULL: auto */
} g3r_options;

#define G3R_NO_SENSOR UINT32_MAX

/* A mesh owned by the library until g3r_mesh_free(). Triangles are counter-clockwise seen from outside. */
typedef struct g3r_mesh {
  size_t vertex_count;
  size_t triangle_count;
  const double* vertices;    /* vertex_count x 3 */
  const uint32_t* triangles; /* triangle_count x 3 */
} g3r_mesh;

/* Sets the defaults; `size` is sizeof(g3r_options). */
G3R_C_API void g3r_options_init(g3r_options* options, size_t size);

/* Outward unit normals of `count` points into `normals` (count x 3). `areas` and `confidence` (count each) may be NULL, as may
 * `options`. On failure the outputs are left as they were. */
G3R_C_API g3r_status g3r_orient(const double* points, size_t count, const g3r_options* options, double* normals, double* areas,
                                float* confidence);

/* The same and a mesh into *mesh, to be freed. `normals`, `areas` and `confidence` may be NULL. */
G3R_C_API g3r_status g3r_reconstruct(const double* points, size_t count, const g3r_options* options, double* normals, double* areas,
                                     float* confidence, g3r_mesh** mesh);

/* What the last call of these two that returned G3R_OK in this thread did and how it went, as JSON (docs/report.md): warnings, whether the
 * solver converged and the sides are consistent, the check of the mesh. Valid until the next one; "" if there was none. */
G3R_C_API const char* g3r_last_report(void);

/* Frees a mesh; NULL is fine. */
G3R_C_API void g3r_mesh_free(g3r_mesh* mesh);

/* Clouds of any size, tile by tile, in a work folder that holds all state (g3r/tiles.h, docs/tiles.md). What is there is complete or
 * absent: a process may be killed at any time, and the same call then goes on. */

/* Set `size` to sizeof(g3r_tiles_info) before a call; members are only ever added at the end. */
typedef struct g3r_tiles_info {
  size_t size;
  uint64_t points;     /* in the input */
  uint64_t non_finite; /* of them, which take no part */
  uint64_t tiles;
  uint64_t done;
  uint64_t coarse_points;       /* of the thinned cloud */
  uint64_t largest_tile;        /* points of the largest solve */
  uint64_t worker_memory_bytes; /* planned, of the largest tile */
  uint64_t disk_bytes;          /* planned, of the whole folder at its fullest */
  double work;                  /* points of all solves over the points */
  double open_share;            /* of the thinned cloud, as the next four */
  double undecided_share;
  int converged;
  int consistent;
  int doubtful;
} g3r_tiles_info;

/* Plans `tiles` tiles (0: as few as the memory allows) of the points in `inputs` (input_count paths: files, folders, patterns). Of
 * `options`, which may be NULL, it takes max_memory, threads, device, progress and the hints, without sensor_of_point. `info` may be NULL,
 * here and below. A folder that holds the plan of the same files and options is left as it is. */
G3R_C_API g3r_status g3r_tiles_plan(const char* const* inputs, size_t input_count, const char* folder, size_t tiles,
                                    const g3r_options* options, g3r_tiles_info* info);

/* Solves the tiles number `worker`, worker + workers, ... (from 1) that are not done. Of `options`: threads, device, progress. */
G3R_C_API g3r_status g3r_tiles_run(const char* folder, size_t worker, size_t workers, const g3r_options* options, g3r_tiles_info* info);

/* What is planned and done. */
G3R_C_API g3r_status g3r_tiles_status(const char* folder, g3r_tiles_info* info);

/* Writes one .ply, .las or .laz of all points in the order of the input, with normals and confidence. Of `options`: progress.
 * What LAS cannot hold as it is, such as all digits of a coordinate, becomes what it can, and this function does not say so: callers who
 * have to know use merge_tiles() (MergedTiles::warnings in g3r/tiles.h), `g3r tiles merge` or Python, or write a .ply. */
G3R_C_API g3r_status g3r_tiles_merge(const char* folder, const char* output, const g3r_options* options);

/* What a status means, one line. */
G3R_C_API const char* g3r_status_text(g3r_status status);

/* What the last failed call of this thread complained of, one line; valid until its next call. */
G3R_C_API const char* g3r_last_error(void);

/* "major.minor.patch" */
G3R_C_API const char* g3r_version(void);

#ifdef __cplusplus
}
#endif

#endif

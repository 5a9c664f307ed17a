/* The same through the C interface. */
#include <g3r/g3r_c.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int calls = 0;

static int count_calls(void* user, const char* stage, double fraction) {
  (void)stage;
  ++calls;
  return fraction <= 1 && *(int*)user;
}

int main(void) {
  enum { kCount = 500 };
  static double points[3 * kCount], normals[3 * kCount];
  static float confidence[kCount];
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount, r = sqrt(1 - z * z), turn = 2.399963 * i;
    points[3 * i] = r * cos(turn);
    points[3 * i + 1] = r * sin(turn);
    points[3 * i + 2] = z;
  }
  int go_on = 1;
  g3r_options options;
  g3r_options_init(&options, sizeof options);
  options.progress = count_calls;
  options.user = &go_on;
  g3r_status status = g3r_orient(points, kCount, &options, normals, NULL, confidence);
  if (status != G3R_OK || calls == 0) return printf("%s: %s\n", g3r_status_text(status), g3r_last_error()), 1;
  for (int i = 0; i < kCount; ++i) {
    const double cosine = points[3 * i] * normals[3 * i] + points[3 * i + 1] * normals[3 * i + 1] + points[3 * i + 2] * normals[3 * i + 2];
    if (cosine < 0.8 || confidence[i] < 0 || confidence[i] > 1) return printf("point %d is wrong\n", i), 1;
  }
  const double sensors[6] = {0, 0, 0.1, 0, 0, 9};
  uint32_t sensor_of_point[kCount];
  for (int i = 0; i < kCount; ++i) sensor_of_point[i] = i % 3 == 0 ? 0 : G3R_NO_SENSOR;
  options.sensors = sensors;
  options.sensor_count = 2;
  options.sensor_of_point = sensor_of_point;
  status = g3r_orient(points, kCount, &options, normals, NULL, NULL);
  if (status != G3R_OK || normals[2] > -0.8) return printf("a sensor inside does not turn the sphere: %s\n", g3r_last_error()), 1;
  options.flip = 1;
  status = g3r_orient(points, kCount, &options, normals, NULL, NULL);
  if (status != G3R_OK || normals[2] < 0.8) return printf("flip does not turn it back: %s\n", g3r_last_error()), 1;
  sensor_of_point[7] = 2;
  if (g3r_orient(points, kCount, &options, normals, NULL, NULL) != G3R_INVALID_INPUT) return puts("sensor 2 of 2 is taken"), 1;
  options.sensors = NULL;
  if (g3r_orient(points, kCount, &options, normals, NULL, NULL) != G3R_INVALID_INPUT) return puts("sensors at NULL are taken"), 1;
  options.sensor_count = 0;
  options.sensor_of_point = NULL;
  options.device = "tpu";
  if (g3r_orient(points, kCount, &options, normals, NULL, NULL) != G3R_INVALID_INPUT) return puts("an unknown device was taken"), 1;
  options.device = "cpu";
  if (g3r_orient(points, kCount, &options, normals, NULL, NULL) != G3R_OK) return puts("the processor was not taken"), 1;
  g3r_mesh* mesh = NULL;
  status = g3r_reconstruct(points, kCount, NULL, NULL, NULL, NULL, &mesh);
  if (status == G3R_OK) {
    if (mesh->triangle_count == 0 || mesh->triangles[0] >= mesh->vertex_count) return puts("the mesh is wrong"), 1;
    printf("%zu triangles\n", mesh->triangle_count);
  } else if (status != G3R_UNAVAILABLE) {
    return printf("%s: %s\n", g3r_status_text(status), g3r_last_error()), 1;
  }
  g3r_mesh_free(mesh);
  go_on = 0;
  if (g3r_orient(points, kCount, &options, normals, NULL, NULL) != G3R_CANCELLED) return puts("cannot be cancelled"), 1;
  if (g3r_orient(points, 2, NULL, normals, NULL, NULL) != G3R_INVALID_INPUT) return puts("two points are taken"), 1;
  printf("g3r %s from C: %s\n", g3r_version(), g3r_last_error());
  return 0;
}

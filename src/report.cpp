// Stats and MeshCheck as JSON.
#include <g3r/g3r.h>

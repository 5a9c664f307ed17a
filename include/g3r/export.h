// What the shared library shows: everything declared in a `namespace G3R_PUBLIC g3r` block, and nothing else.
#pragma once

#if defined(__GNUC__)
#define G3R_PUBLIC [[gnu::visibility("default")]]
#else
#define G3R_PUBLIC
#endif

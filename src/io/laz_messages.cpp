// In place of LASzip's lasmessage.cpp, which prints warnings to the standard error, as no library should. What is wrong with a file it
// throws.
#include <lasmessage.hpp>

long lasmessage_cnt[LAS_QUIET];

// NOLINTNEXTLINE(cert-dcl50-cpp): LASzip's
void LASMessage(LAS_MESSAGE_TYPE /*type*/, const char* /*format*/, ...) {}

void flush_repeated_logs() {}

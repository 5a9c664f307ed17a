// What LASzip has to say, in place of its lasmessage.cpp, which prints it: nothing. It warns of memory that the system may lack, by what
// Linux says of it, so everywhere else of any megabyte; what is wrong with a file it throws.
#include <lasmessage.hpp>

long lasmessage_cnt[LAS_QUIET];

// NOLINTNEXTLINE(cert-dcl50-cpp): LASzip's
void LASMessage(LAS_MESSAGE_TYPE /*type*/, const char* /*format*/, ...) {}

void flush_repeated_logs() {}

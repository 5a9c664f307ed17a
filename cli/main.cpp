// The g3r program.
#include <g3r/g3r.h>

#include <iostream>

int main() { std::cout << g3r::version() << "\n"; }

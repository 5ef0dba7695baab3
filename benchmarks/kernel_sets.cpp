// Prints which kernels round here: scripts that test, compare or measure show it in their logs.
#include <fmt/format.h>

#include "benchmarks/conditions.h"

int main() { fmt::print("{}\n", isosyrk::kernel_sets()); }

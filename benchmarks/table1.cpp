// Table 1 of the paper: CPU time of 50 steps of each formulation as published, over n and s.
#include "benchmarks/table_program.h"

namespace isosyrk::table1 {

int main_program(int argc, char** argv) { return time_table(Solver::published, argc, argv); }

}  // namespace isosyrk::table1

// Table 2: the cells of Table 1 by the fast form of each formulation.
#include "benchmarks/table_program.h"

namespace isosyrk::table2 {

int main_program(int argc, char** argv) { return time_table(Solver::fast, argc, argv); }

}  // namespace isosyrk::table2

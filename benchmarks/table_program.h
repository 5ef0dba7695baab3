// What table1 and table2 share: the cells of the paper's table, timed.
#pragma once

#include "isosyrk/catalogue/solver.h"

namespace isosyrk {

/// The program: times 50 steps of each cell, n = 17, 33, 65, 129, s = 1, 2, 3, and returns its exit
/// code.  The table of the fast forms takes the published ones too, by --published, and its own
/// cells again with several threads, by --threads N.  All are timed interleaved if Google Benchmark
/// is asked to interleave.  Throws BadArgument.
int time_table(Solver solver, int argc, char** argv);

}  // namespace isosyrk

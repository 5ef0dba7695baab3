// Table 1 of the paper: CPU time of 50 steps of each formulation as published, over n and s.
#include "benchmarks/product_rate.h"
#include "benchmarks/table_program.h"
#include "core/gauss_tableau.h"

int main(int argc, char** argv) {
  using namespace isosyrk;
  const TableProgram table = {
      .name = "table1",
      .description =
          "Times 50 steps of each formulation at n = 17, 33, 65, 129 and s = 1, 2, 3 (the paper's "
          "Table 1).",
      .make =
          [](Formulation formulation, int stages, const Flow& flow, const SolverOptions& options,
             ProductBackend backend) {
            return make_formulation(formulation, flow, gauss_tableau(stages), options, backend);
          },
      .product_rate = product_rate,
  };
  return table_main(table, argc, argv);
}

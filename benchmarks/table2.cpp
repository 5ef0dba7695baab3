// Table 2: the cells of Table 1 by the fast form of each formulation.
#include <fmt/format.h>

#include "benchmarks/product_rate.h"
#include "benchmarks/table_program.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk::table2 {
namespace {

TableProgram fast_table(int threads) {
  return {
      .name = "table2",
      .threads = threads,
      .description =
          "Times 50 steps of the fast form of each formulation at n = 17, 33, 65, 129 and "
          "s = 1, 2, 3: the answers of Table 1, sooner.",
      .make =
          [threads](Formulation formulation, int stages, const Flow& flow,
                    const SolverOptions& options, ProductBackend) {
            return make_fast_gauss(formulation, stages, flow,
                                   {.solver = options, .threads = threads});
          },
      .product_rate = [](ProductBackend, Index n,
                         double seconds) { return split_product_rate(n, seconds); },
      .has_backends = false,
      .counts_equivalents = true,
      .conditions =
          {{"products", fmt::format("split, {} kernels", gemm_kernels().front().name)},
           {"start",
            fmt::format("from the last {} steps, {} from n = 48 on, by weights fitted to how they "
                        "followed from each other; cold at first",
                        tuning.past_steps(17), tuning.past_steps(48))},
           {"update_order",
            "residuals in double precision, Jacobi; Newton corrections in single precision; from "
            "n = 48 on without what lies so far off the diagonal that it comes to a hundredth of "
            "the tolerance"}},
  };
}

}  // namespace

int main_program(int argc, char** argv) {
  const TableProgram table = fast_table(1);
  const TableProgram published = published_table();
  return time_table(table, {.published = &published, .with_threads = fast_table}, argc, argv);
}

}  // namespace isosyrk::table2

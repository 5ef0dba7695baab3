// What table1 and table2 share: the cells of the paper's table, timed.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "benchmarks/conditions.h"
#include "isosyrk/catalogue/integrator_list.h"

namespace isosyrk {

/// What makes one table of the other.
struct TableProgram {
  std::string name;  ///< "table1"; cells are named table1/group/n:17/s:2
  int threads = 1;   ///< cells of 2 threads are named table2/group/n:17/s:2/threads:2
  std::string description;
  std::function<std::unique_ptr<Integrator>(Formulation, int stages, const Flow&,
                                            const SolverOptions&, ProductBackend)>
      make;
  /// Products per second, as product_rate of product_rate.h: what product_share is a share of.
  std::function<double(ProductBackend, Index n, double seconds)> product_rate;
  bool has_backends = true;         ///< takes --products
  bool counts_equivalents = false;  ///< rows have equivalent_products
  Conditions conditions = {};       ///< in place of those of the same name
};

/// Table 1: the published forms.
TableProgram published_table();

/// What a table is compared with on request: its cells are timed too, in turns with the table's own
/// if Google Benchmark is asked to interleave.  With several threads every row has cores_at_once,
/// the least of before and after its run.
struct ComparedTables {
  const TableProgram* published = nullptr;             ///< by --published
  std::function<TableProgram(int)> with_threads = {};  ///< by --threads N, N > 1
};

/// The program: times 50 steps of each cell, n = 17, 33, 65, 129, s = 1, 2, 3, and returns its exit
/// code.  The tables must outlive it.  Throws BadArgument.
int time_table(const TableProgram& table, const ComparedTables& compared, int argc, char** argv);

}  // namespace isosyrk

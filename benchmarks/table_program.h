// What table1 and table2 share: the cells of the paper's table, timed.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "benchmarks/conditions.h"
#include "core/integrator_list.h"

namespace isosyrk {

/// What makes one table of the other.
struct TableProgram {
  std::string name;  ///< "table1"; cells are named table1/group/n:17/s:2
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

/// The program: times 50 steps of each cell, n = 17, 33, 65, 129, s = 1, 2, 3, and returns its exit
/// code.  Where there is a table to compare with, --published times its cells too, in turns with
/// this one's if Google Benchmark is asked to interleave.  The tables must outlive it.
int table_main(const TableProgram& table, const TableProgram* compared_with, int argc, char** argv);

}  // namespace isosyrk

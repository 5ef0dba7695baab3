// The command line of the program integrate.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "benchmarks/arguments.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/catalogue/solver.h"
#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/scenes/scene_list.h"

namespace isosyrk {

/// What integrate is asked to do.  Files are only named: reading a command line touches none.
struct IntegrateRequest {
  Index n = 0;
  std::string name = {};  ///< of the integrator in the list
  IntegratorEntry integrator = {};
  std::optional<Formulation> formulation = {};  ///< where the integrator was chosen by this
  Solver solver = Solver::published;
  int threads = 1;  ///< of the fast solver
  double step = 0.0;
  double time = 0.0;
  long steps = 0;
  IterationOptions iteration = {};
  std::optional<HbarConvention> hbar = {};                ///< of Euler-Zeitlin; none: paper
  std::optional<std::pair<Index, Index>> signature = {};  ///< of pseudo_unitary
  BackendChoice products = {};
  std::string scene = "smooth";                  ///< "modes" or "initial" where a file has them
  std::optional<std::string> modes_file = {};    ///< none: those of the named scene
  std::optional<std::string> initial_file = {};  ///< W at time 0, in place of modes
  std::optional<std::string> output_file = {};
  std::optional<long> every =
      {};  ///< steps from one row of the series, and one snapshot, to the next
  std::optional<std::string> snapshots_folder = {};
  std::optional<std::string> series_file = {};
  bool resume = false;  ///< from the checkpoint in snapshots_folder
  bool json = false;

  bool is_euler_zeitlin() const {
    return isosyrk::is_euler_zeitlin(scene) || scene == "modes" || scene == "initial";
  }
};

/// Reads the command line; an exit code if that was all, as for --help.  Throws BadArgument for
/// what is not allowed.
std::variant<IntegrateRequest, int> read_integrate_arguments(int argc, char** argv);

}  // namespace isosyrk

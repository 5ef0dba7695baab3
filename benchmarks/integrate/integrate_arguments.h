// The command line of the program integrate.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "benchmarks/arguments.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/scenes/scene_list.h"

namespace isosyrk {

/// What integrate is asked to do.  Files are only named: reading a command line touches none.
struct IntegrateRequest {
  Index n;
  IntegratorEntry integrator;
  std::optional<Formulation> formulation;  ///< where it was chosen by this
  std::string method;                      ///< "published" or "fast": how it is solved
  int threads;                             ///< of the fast solver
  double step;
  double time;
  long steps;
  IterationOptions solver;
  std::optional<HbarConvention> hbar;                ///< of Euler-Zeitlin; none: paper
  std::optional<std::pair<Index, Index>> signature;  ///< of pseudo_unitary
  BackendChoice products;
  std::string scene;                        ///< "modes" or "initial" where a file has them
  std::optional<std::string> modes_file;    ///< none: those of the named scene
  std::optional<std::string> initial_file;  ///< W at time 0, in place of modes
  std::optional<std::string> output_file;
  bool json;

  bool is_euler_zeitlin() const {
    return isosyrk::is_euler_zeitlin(scene) || scene == "modes" || scene == "initial";
  }
};

/// Reads the command line; an exit code if that was all, as for --help.  Throws BadArgument for
/// what is not allowed.
std::variant<IntegrateRequest, int> read_integrate_arguments(int argc, char** argv);

}  // namespace isosyrk

// Reference solutions: W(T) of a scene to near rounding, computed once and kept in files.
#pragma once

#include <string>

#include "benchmarks/arguments.h"
#include "benchmarks/program.h"
#include "isosyrk/flows/scene.h"

namespace isosyrk {

/// How one integrator came to its answer.
struct ReferenceRun {
  std::string integrator;
  long steps = 0;
  double estimate = 0.0;  ///< of its own relative error, from the last doubling of the steps
  long products = 0;
};

/// W(T) from two integrators of different kinds.
struct Reference {
  Matrix W;                  ///< from `first`
  double uncertainty = 0.0;  ///< ‖W - W of `second`‖_F / ‖W‖_F
  ReferenceRun first;
  ReferenceRun second;
};

/// The two integrators disagree, or one of them failed.
class UncertainReference : public SolverFailed {
 public:
  using SolverFailed::SolverFailed;
};

/// ‖W - reference‖_F / ‖reference‖_F
double relative_error(const Matrix& W, const Matrix& reference);

/// Solves the scene to its end time with Gauss s = 5 in the group form and with explicit RKMK of
/// order 4, doubling the steps of each until a further doubling would not show; the difference of
/// the two is the uncertainty.  Throws UncertainReference if they differ by `largest` or more.
Reference compute_reference(const Scene& scene, ProductBackend backend, double largest = 1e-12);

/// The file in `folder` that holds the reference of the smooth scene at n with these modes.
std::string reference_path(const std::string& folder, Index n);

/// As JSON, with what it is a solution of: n, T, ħ, the hash of the modes.
std::string to_json(const Reference& reference, const Scene& scene, HbarConvention hbar,
                    const std::vector<Mode>& modes);

/// Reads the reference of this scene.  Throws BadArgument, naming `option` and the file, for one
/// that is missing, broken or of another scene.
Reference read_reference(const std::string& option, const std::string& folder, const Scene& scene,
                         HbarConvention hbar, const std::vector<Mode>& modes);

}  // namespace isosyrk

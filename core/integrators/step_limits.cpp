#include "isosyrk/integrators/step_limits.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <limits>
#include <stdexcept>

namespace isosyrk {

double spectral_radius(const Tableau& tableau) {
  RealMatrix a = tableau.a;  // LAPACK's workspace
  const auto s = static_cast<lapack_int>(tableau.stages());
  RealVector re(s);
  RealVector im(s);
  const lapack_int info = LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', s, a.data(), s, re.data(),
                                        im.data(), nullptr, 1, nullptr, 1);
  if (info != 0) throw std::runtime_error(fmt::format("spectral_radius: dgeev failed ({})", info));
  return (re.array().square() + im.array().square()).sqrt().maxCoeff();
}

double adjoint_limit(double limit, const RealVector& frequencies) {
  return limit / (frequencies.maxCoeff() - frequencies.minCoeff());
}

double stage_iteration_limit(const Tableau& tableau, const RealVector& frequencies) {
  return 1.0 / (spectral_radius(tableau) * frequencies.cwiseAbs().maxCoeff());
}

double direct_iteration_limit(const Tableau& tableau, const RealVector& frequencies) {
  return adjoint_limit(1.0 / spectral_radius(tableau), frequencies);
}

// For each entry, with a = h²/4, d = (β_p - β_q)² and m = β_p² β_q²:  a d + a² m = 1, so that
// a = 2 / (d + √(d² + 4m)).
double midpoint_iteration_limit(const RealVector& frequencies) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const double p : frequencies) {
    for (const double q : frequencies) {
      const double d = (p - q) * (p - q);
      const double a = 2.0 / (d + std::sqrt(d * d + 4.0 * p * p * q * q));
      smallest = std::min(smallest, 2.0 * std::sqrt(a));
    }
  }
  return smallest;
}

}  // namespace isosyrk

#include "isosyrk/integrators/step_limits.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace isosyrk {
namespace {

// Stored by columns, for LAPACK.
using ComplexMatrix = Eigen::MatrixXcd;
using ComplexVector = Eigen::VectorXcd;

// Returns the solution of M x = b.  Throws std::runtime_error if M is singular.
ComplexVector solution(ComplexMatrix M, ComplexVector b) {
  const auto s = static_cast<lapack_int>(M.rows());
  std::vector<lapack_int> pivots(static_cast<std::size_t>(s));
  const lapack_int info =
      LAPACKE_zgesv(LAPACK_COL_MAJOR, s, 1, M.data(), s, pivots.data(), b.data(), s);
  if (info != 0) throw std::runtime_error(fmt::format("linear theory: zgesv failed ({})", info));
  return b;
}

}  // namespace

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

// In entry (q, p), for W₀ with a 1 there and Y_i = Σ_j a_ij X_j:
//     Y = -ihβ_p A (1 + Y),    K_i = ihβ_q (Y_i + A K_i)  for each row i of K.
double hermitian_growth(const Tableau& tableau, const RealVector& frequencies, double h) {
  const Index s = tableau.stages();
  const ComplexMatrix identity = ComplexMatrix::Identity(s, s);
  const ComplexMatrix A = tableau.a.cast<Complex>();
  double largest = 0.0;
  for (const double q : frequencies) {
    for (const double p : frequencies) {
      const Complex x(0.0, h * p);
      const Complex y(0.0, h * q);
      const ComplexVector Y = solution(identity + x * A, -x * tableau.c.cast<Complex>());
      // Every row of K is Y_i times the same vector.
      const ComplexVector row = solution(identity - y * A, ComplexVector::Constant(s, y));
      Complex sum = 0.0;
      for (Index i = 0; i < s; ++i) {
        const Complex k = Y(i) * A.row(i).transpose().cwiseProduct(row).sum();
        sum += tableau.b(i) * (1.0 + std::conj(k));
      }
      largest = std::max(largest, std::abs(1.0 + Complex(0.0, h * (p - q)) * sum));
    }
  }
  return largest;
}

}  // namespace isosyrk

#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {

/// The Euler top, n = 3: W is the matrix of x -> m × x with m = (0.6, -0.48, 0.64), and
///
///     m' = ω × m,   ω_k = m_k / I_k,   I_k = d_i + d_j for the other two i and j,
///
/// with moments of inertia I = (3, 2.5, 1.5).  The sign is opposite to the
/// body-frame equation m' = m × ω.
Scene euler_top(const SceneParameters& parameters) {
  if (parameters.n != 3) {
    throw std::invalid_argument(fmt::format("n = {}: euler_top has n = 3", parameters.n));
  }
  const double m[3] = {0.6, -0.48, 0.64};
  Matrix W = Matrix::Zero(3, 3);
  for (Index k = 0; k < 3; ++k) {
    W((k + 2) % 3, (k + 1) % 3) = m[k];
    W((k + 1) % 3, (k + 2) % 3) = -m[k];
  }
  const RealVector d = Eigen::Vector3d(0.5, 1.0, 2.0);
  return {"euler_top",
          std::make_shared<RealRigidBody>(QuadraticAlgebra::skew_hermitian(3), manakov_inertia(d)),
          W, 5.0};
}

}  // namespace isosyrk::scenes

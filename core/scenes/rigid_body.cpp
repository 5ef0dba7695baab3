// Free rigid bodies on so(n): the Euler top, and one in n dimensions.
#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/scenes/normal_numbers.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {
namespace {

Scene scene_of(std::string name, const RealVector& d, Matrix W) {
  auto flow = std::make_shared<RealRigidBody>(QuadraticAlgebra::skew_hermitian(d.size()),
                                              manakov_inertia(d));
  return {std::move(name), std::move(flow), std::move(W), 5.0};
}

}  // namespace

/// The Euler top, n = 3: W is the matrix of x -> m × x with m = (0.6, -0.48, 0.64), and
///
///     m' = ω × m,   ω_k = m_k / I_k,   I_k = d_i + d_j for the other two i and j,
///
/// with moments of inertia I = (3, 2.5, 1.5).  In the body's own frame time runs backwards.
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
  return scene_of("euler_top", Eigen::Vector3d(0.5, 1.0, 2.0), W);
}

/// A rigid body in n >= 3 dimensions with Manakov's inertia, d_i from 0.5 to 2, and a random
/// angular momentum of spectral norm 1.
Scene rigid_body(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 3) throw std::invalid_argument(fmt::format("n = {}: rigid_body has n >= 3", n));
  NormalNumbers normal;
  Matrix W = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = i + 1; j < n; ++j) {
      W(i, j) = normal.next();
      W(j, i) = -W(i, j);
    }
  }
  return scene_of("rigid_body", RealVector::LinSpaced(n, 0.5, 2.0), W / spectral_norm(W));
}

}  // namespace isosyrk::scenes

#include "isosyrk/tableaux/multistep_schemes.h"

#include <Eigen/Eigenvalues>

#include "isosyrk/tableaux/explicit_tableaux.h"

namespace isosyrk {
namespace {

RealVector over(double denominator, const RealVector& numerators) {
  return numerators / denominator;
}

}  // namespace

const MultistepScheme& adams_bashforth_moulton8() {
  static const MultistepScheme scheme{
      .name = "abm8",
      .order = 8,
      .predictor = over(60480.0, RealVector{{198721.0, -447288.0, 705549.0, -688256.0, 407139.0,
                                             -134472.0, 19087.0}}),
      .of_predicted = 36799.0 / 120960.0,
      .corrector = over(120960.0, RealVector{{139849.0, -121797.0, 123133.0, -88547.0, 41499.0,
                                              -11351.0, 1375.0}}),
      .start = dormand_prince8().tableau,
      .imaginary_limit = 0.374};
  return scheme;
}

double growth_of_a_step(const MultistepScheme& scheme, double y) {
  const Complex z(0.0, y);
  const Index count = scheme.predictor.size();
  // w₁ = Σ_j c_j w_{-j} with w₀ ... w_{-6}.
  Eigen::MatrixXcd companion = Eigen::MatrixXcd::Zero(count, count);
  companion.bottomLeftCorner(count - 1, count - 1).setIdentity();
  companion.row(0) =
      (z * z * scheme.of_predicted * scheme.predictor + z * scheme.corrector).transpose();
  companion(0, 0) += 1.0 + z * scheme.of_predicted;
  return companion.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace isosyrk

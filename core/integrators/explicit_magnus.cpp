#include "isosyrk/integrators/explicit_magnus.h"

#include "isosyrk/integrators/flow_requirements.h"

namespace isosyrk {

template <class Scalar>
LieAlongFlow<Scalar>::LieAlongFlow(const QuadraticAlgebra& algebra,
                                   AdjointRotation<Scalar>& rotation, ProductsOf<Scalar>& products,
                                   bool is_linear, GeneratorFunction generator)
    : PublishedLie<Scalar>(algebra, rotation, products, std::move(generator)),
      is_linear_(is_linear) {
  if (!is_linear) W_shifted_ = B_shifted_ = this->zero();
}

// D = (8 (B(W + εk) - B(W - εk)) - (B(W + 2εk) - B(W - 2εk))) / (12ε), exact to O(ε⁴).
template <class Scalar>
void LieAlongFlow<Scalar>::differentiate(M& D, const M& W, const M& k) {
  if (is_linear_) return this->generate(D, k);
  constexpr double part = 1e-3;  // of ‖W‖: balances ε⁴ with rounding / ε
  const double size = k.norm();
  D.setZero();
  if (!(size > 0.0)) return;
  const double epsilon = part * W.norm() / size;
  for (const auto& [shift, weight] :
       {std::pair{1.0, 8.0}, {-1.0, -8.0}, {2.0, -1.0}, {-2.0, 1.0}}) {
    W_shifted_ = W + (shift * epsilon) * k;
    this->generate(B_shifted_, W_shifted_);
    D += (weight / (12.0 * epsilon)) * B_shifted_;
  }
}

template <class Scalar>
ExplicitMagnus<Scalar>::ExplicitMagnus(SharedFlowIn<Scalar> flow, const MagnusScheme& scheme,
                                       ProductBackend backend)
    : Form(std::move(flow), backend),
      rotation_(algebra()),
      lie_(algebra(), rotation_, products_, this->flow().kind() == Generator::linear,
           [this](const Stored& W, Stored& B) { generator(W, B); }),
      exponent_(lie_, scheme),
      Omega_(zero()),
      mean_(zero()) {
  require_identity_J(this->flow(), scheme.name);
}

template <class Scalar>
StepReport ExplicitMagnus<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  exponent_.form_exponent(Omega_, W0, h);
  const bool summed = rotation_.rotate(products_, Omega_, W0, W1, mean_);
  return {.status = summed ? Status::converged : Status::diverged};
}

template class LieAlongFlow<double>;
template class LieAlongFlow<Complex>;
template class ExplicitMagnus<double>;
template class ExplicitMagnus<Complex>;

}  // namespace isosyrk

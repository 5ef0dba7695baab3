#include "isosyrk/integrators/exponential_lie_poisson.h"

#include <fmt/format.h>

#include <limits>

#include "isosyrk/integrators/flow_requirements.h"
#include "isosyrk/integrators/unit_of_exponent.h"

namespace isosyrk {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace

template <class Scalar>
ExponentialLiePoisson<Scalar>::ExponentialLiePoisson(SharedFlowIn<Scalar> flow, int order,
                                                     const IterationOptions& options,
                                                     ProductBackend backend)
    : Form(std::move(flow), options, backend),
      order_(order),
      tolerance_(options.tolerance),
      rotation_(algebra()),
      lie_(algebra(), rotation_, products_,
           [this](const Stored& W, Stored& B) { generator(W, B); }),
      gradient_(lie_, order) {
  const std::string name = fmt::format("elp{}", order);
  require_identity_J(this->flow(), name);
  if (order > 2) require_self_adjoint_generator(this->flow(), name);
  Omega_ = Omega_next_ = mu_ = v_ = rotated_ = zero();
  if (order > 2) beyond_v_ = zero();
}

template <class Scalar>
void ExponentialLiePoisson<Scalar>::start(const Stored&) {
  Omega_.setZero();
}

template <class Scalar>
double ExponentialLiePoisson<Scalar>::sweep(const Stored& W0, double h) {
  if (!rotation_.rotate(products_, Omega_, W0, rotated_, mu_)) return not_a_number;
  lie_.generate(v_, mu_);
  if (order_ > 2) {
    gradient_.evaluate(beyond_v_, mu_, v_, h, {.second = true, .fourth = order_ == 6});
    v_ += beyond_v_;
  }
  Omega_next_ = h * v_;
  Omega_.swap(Omega_next_);
  const double change = std::sqrt(squared_change(Omega_, Omega_next_));
  const double least = least_unit_of_exponent(std::abs(h) * rotation_left_out(W0), tolerance_);
  return change / unit_of_exponent(Omega_.norm(), least);
}

template <class Scalar>
void ExponentialLiePoisson<Scalar>::update(const Stored& W0, double, Stored& W1) {
  const bool summed = rotation_.rotate(products_, Omega_, W0, W1, mu_);
  if (!summed) W1.setConstant(not_a_number);  // the step diverges
}

template class ExponentialLiePoisson<double>;
template class ExponentialLiePoisson<Complex>;

}  // namespace isosyrk

#include "isosyrk/integrators/bogfjellmo_marthinsen.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "isosyrk/integrators/exponential_lie_poisson.h"
#include "isosyrk/integrators/flow_requirements.h"
#include "isosyrk/integrators/unit_of_exponent.h"

namespace isosyrk {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// 1 / k!
double over_factorial(std::size_t k) { return 1.0 / std::tgamma(static_cast<double>(k) + 1.0); }

// The exponential step of order 2, refused under the name of the method that is composed of it.
template <class Scalar>
std::unique_ptr<IntegratorIn<Scalar>> substep_of(SharedFlowIn<Scalar> flow,
                                                 const CompositionScheme& weights,
                                                 const IterationOptions& options,
                                                 ProductBackend backend) {
  require_identity_J(*flow, fmt::format("cg{}", weights.order));
  return std::make_unique<ExponentialLiePoisson<Scalar>>(flow, 2, options, backend);
}

}  // namespace

template <class Scalar>
BogfjellmoMarthinsen<Scalar>::BogfjellmoMarthinsen(SharedFlowIn<Scalar> flow,
                                                   const Tableau& tableau,
                                                   const IterationOptions& options,
                                                   ProductBackend backend)
    : Form(std::move(flow), options, backend),
      tableau_(tableau),
      terms_(tableau.order - 2),
      tolerance_(options.tolerance),
      rotation_(algebra()) {
  require_consistent(tableau_);
  require_identity_J(this->flow(), fmt::format("bm{}", tableau_.stages()));
  if ((tableau_.b.array() == 0.0).any()) {
    throw std::invalid_argument(
        fmt::format("tableau {}: no b_i may be 0 in a method on the cotangent bundle of a group",
                    tableau_.name));
  }
  v_ = mu_ = xi_ = pulled_ = D_ = zeros(tableau_.stages());
  of_v_ = of_mu_ = zeros(terms_ + 1);
  Omega_ = Omega_stage_ = lambda_ = rotated_ = sum_ = bracket_ = next_ = zero();
}

template <class Scalar>
void BogfjellmoMarthinsen<Scalar>::start(const Stored& W0) {
  generator(W0, v_[0]);
  for (Stored& v : v_) v = v_[0];
  for (Stored& mu : mu_) mu = W0;
}

// Sets xi_, pulled_ and D_ of a stage.
template <class Scalar>
void BogfjellmoMarthinsen<Scalar>::form_stage(std::size_t i, double h) {
  Omega_stage_.setZero();
  add_slopes(h * tableau_.a.row(static_cast<Index>(i)), v_, Omega_stage_);
  const std::size_t K = of_v_.size() - 1;
  of_v_[0] = xi_[i] = v_[i];
  of_mu_[0] = pulled_[i] = mu_[i];
  for (std::size_t k = 1; k <= K; ++k) {
    rotation_.commutator(products_, Omega_stage_, of_v_[k - 1], of_v_[k]);
    rotation_.commutator(products_, of_mu_[k - 1], Omega_stage_, of_mu_[k]);
    xi_[i] += over_factorial(k + 1) * of_v_[k];
    pulled_[i] += over_factorial(k + 1) * of_mu_[k];
  }
  D_[i].setZero();
  for (std::size_t q = 0; q < K; ++q) {
    sum_.setZero();
    for (std::size_t p = 0; p + q < K; ++p) sum_ += over_factorial(p + q + 2) * of_mu_[p];
    rotation_.commutator(products_, of_v_[q], sum_, bracket_);
    D_[i] += bracket_;
  }
}

template <class Scalar>
double BogfjellmoMarthinsen<Scalar>::sweep(const Stored& W0, double h) {
  Omega_.setZero();
  add_slopes(h * tableau_.b, v_, Omega_);
  if (!rotation_.rotate(products_, Omega_, W0, rotated_, lambda_)) return not_a_number;
  for (std::size_t i = 0; i < v_.size(); ++i) form_stage(i, h);

  double largest = 0.0;
  for (std::size_t j = 0; j < v_.size(); ++j) {
    const double b = tableau_.b(static_cast<Index>(j));
    next_ = mu_[j] + lambda_ - pulled_[j];
    add_slopes((-h / b) * tableau_.b.cwiseProduct(tableau_.a.col(static_cast<Index>(j))), D_,
               next_);
    largest = larger(largest, std::sqrt(squared_change(next_, mu_[j])));
    mu_[j].swap(next_);
  }
  const double least = least_unit_of_exponent(std::abs(h) * rotation_left_out(W0), tolerance_);
  for (std::size_t i = 0; i < v_.size(); ++i) {
    generator(mu_[i], next_);
    next_ += v_[i] - xi_[i];
    const double change = std::abs(h) * std::sqrt(squared_change(next_, v_[i]));
    largest = larger(largest, change / unit_of_exponent(std::abs(h) * next_.norm(), least));
    v_[i].swap(next_);
  }
  return largest;
}

template <class Scalar>
void BogfjellmoMarthinsen<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  Omega_.setZero();
  add_slopes(h * tableau_.b, v_, Omega_);
  const bool summed = rotation_.rotate(products_, Omega_, W0, W1, lambda_);
  if (!summed) W1.setConstant(not_a_number);  // the step diverges
}

template <class Scalar>
CrouchGrossman<Scalar>::CrouchGrossman(SharedFlowIn<Scalar> flow, const CompositionScheme& weights,
                                       const IterationOptions& options, ProductBackend backend)
    : Composition<Scalar>(flow, weights, substep_of<Scalar>(flow, weights, options, backend)) {}

template class BogfjellmoMarthinsen<double>;
template class BogfjellmoMarthinsen<Complex>;
template class CrouchGrossman<double>;
template class CrouchGrossman<Complex>;

}  // namespace isosyrk

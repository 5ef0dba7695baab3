// The exponents of the explicit Magnus methods, written once for published and fast forms.
#pragma once

#include <algorithm>
#include <vector>

#include "isosyrk/integrators/lie_operations.h"
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/magnus_schemes.h"

namespace isosyrk {

/// Ω of a Magnus method from the moments m_k of B over a step, as MagnusScheme says.
template <LieOperations Lie>
class ExponentOfMoments {
 public:
  using M = typename Lie::M;

  /// The operations must outlive it.  Only the constructor allocates.
  ExponentOfMoments(Lie& lie, const MagnusScheme& scheme);

  /// Sets Ω from m₀, m₁ ..., of which there are as many as scheme.moments.
  void form(M& Omega, const std::vector<M>& m);

 private:
  using Sum = MagnusScheme::Sum;

  const M& X(const std::vector<M>& m, std::size_t i) const {
    return i < m.size() ? m[i] : X_[i - m.size()];
  }
  void set(M& out, const Sum& sum, const std::vector<M>& m);
  const M& side(M& space, const Sum& sum, const std::vector<M>& m);

  Lie& lie_;
  MagnusScheme scheme_;
  std::vector<M> X_;  // those after the moments
  M left_, right_;    // of a bracket
  std::vector<WeightedTerm<M>> terms_;
};

/// Ω of an explicit Magnus method for W' = [B(W), W].  W at the nodes is given by steps of the
/// classical Runge-Kutta method.  Brackets, for s nodes: 4s - 3 and those of the scheme, which is 6
/// for magnus4() and 12 for magnus5().  Evaluations of B: 4s - 3, and s of its derivative.
template <DifferentiableLieOperations Lie>
class MagnusExponent {
 public:
  using M = typename Lie::M;

  /// The operations must outlive it.  Only the constructor allocates.
  MagnusExponent(Lie& lie, const MagnusScheme& scheme);

  /// Sets Ω for a step of h from W₀.
  void form_exponent(M& Omega, const M& W0, double h);

 private:
  void evaluate(std::size_t node);
  void predict(double h);
  template <class Weights>
  void set_along_slopes(M& out, double h, const Weights& weights);
  void form_moment(std::size_t k, double h);

  Lie& lie_;
  MagnusScheme scheme_;
  Tableau tableau_;      // of the Runge-Kutta steps
  M W_;                  // W at the present node
  std::vector<M> B_;     // B_i = B(W) at the nodes
  std::vector<M> D_;     // D_i = B'(W) [B, W]
  std::vector<M> k_;     // slopes of a Runge-Kutta step; the first is [B, W] at a node
  M B_stage_, W_stage_;  // of such a step
  std::vector<M> m_;     // moments of B
  std::vector<WeightedTerm<M>> terms_;
  ExponentOfMoments<Lie> exponent_;
};

template <LieOperations Lie>
ExponentOfMoments<Lie>::ExponentOfMoments(Lie& lie, const MagnusScheme& scheme)
    : lie_(lie),
      scheme_(scheme),
      X_(scheme.sums.size() + scheme.brackets.size(), lie.zero()),
      left_(lie.zero()),
      right_(left_) {
  terms_.reserve(scheme.moments.size() + X_.size());
}

template <LieOperations Lie>
void ExponentOfMoments<Lie>::form(M& Omega, const std::vector<M>& m) {
  std::size_t next = 0;
  for (const Sum& sum : scheme_.sums) set(X_[next++], sum, m);
  for (const MagnusScheme::Bracket& bracket : scheme_.brackets) {
    const M& left = side(left_, bracket.left, m);
    const M& right = side(right_, bracket.right, m);
    lie_.bracket(X_[next++], left, right, bracket.scale);
  }
  set(Omega, scheme_.Omega, m);
}

template <LieOperations Lie>
void ExponentOfMoments<Lie>::set(M& out, const Sum& sum, const std::vector<M>& m) {
  terms_.clear();
  for (const auto& term : sum) terms_.push_back({term.above / term.below, &X(m, term.of)});
  lie_.combine(out, terms_);
}

// Returns one side of a bracket: an X itself, or a sum, in this space.
template <LieOperations Lie>
auto ExponentOfMoments<Lie>::side(M& space, const Sum& sum, const std::vector<M>& m) -> const M& {
  if (sum.size() == 1 && sum[0].above == sum[0].below) return X(m, sum[0].of);
  set(space, sum, m);
  return space;
}

template <DifferentiableLieOperations Lie>
MagnusExponent<Lie>::MagnusExponent(Lie& lie, const MagnusScheme& scheme)
    : lie_(lie),
      scheme_(scheme),
      tableau_(classical_runge_kutta4().tableau),
      W_(lie.zero()),
      B_(static_cast<std::size_t>(scheme.nodes.size()), W_),
      D_(B_),
      k_(static_cast<std::size_t>(tableau_.stages()), W_),
      B_stage_(W_),
      W_stage_(W_),
      m_(scheme.moments.size(), W_),
      exponent_(lie, scheme) {
  terms_.reserve(std::max(1 + k_.size(), B_.size() + D_.size()));
}

template <DifferentiableLieOperations Lie>
void MagnusExponent<Lie>::form_exponent(M& Omega, const M& W0, double h) {
  W_ = 1.0 * W0;
  evaluate(0);
  for (std::size_t node = 1; node < B_.size(); ++node) {
    const auto i = static_cast<Index>(node);
    predict((scheme_.nodes(i) - scheme_.nodes(i - 1)) * h);
    evaluate(node);
  }
  for (std::size_t k = 0; k < m_.size(); ++k) form_moment(k, h);
  exponent_.form(Omega, m_);
}

// Sets B_i and D_i from W at this node, and the first slope.
template <DifferentiableLieOperations Lie>
void MagnusExponent<Lie>::evaluate(std::size_t node) {
  lie_.cut(W_);
  lie_.generate(B_[node], W_);
  lie_.bracket(k_[0], B_[node], W_);
  lie_.differentiate(D_[node], W_, k_[0]);
}

// Sets W to that of a Runge-Kutta step of h from the node that was evaluated.
template <DifferentiableLieOperations Lie>
void MagnusExponent<Lie>::predict(double h) {
  for (std::size_t i = 1; i < k_.size(); ++i) {
    set_along_slopes(W_stage_, h, tableau_.a.row(static_cast<Index>(i)));
    lie_.cut(W_stage_);
    lie_.generate(B_stage_, W_stage_);
    lie_.bracket(k_[i], B_stage_, W_stage_);
  }
  set_along_slopes(W_, h, tableau_.b);
}

// out = W + h Σ_j weights_j k_j.
template <DifferentiableLieOperations Lie>
template <class Weights>
void MagnusExponent<Lie>::set_along_slopes(M& out, double h, const Weights& weights) {
  terms_.assign(1, {1.0, &W_});
  for (std::size_t j = 0; j < k_.size(); ++j) {
    const double weight = weights(static_cast<Index>(j));
    if (weight != 0.0) terms_.push_back({h * weight, &k_[j]});
  }
  lie_.combine(out, terms_);
}

// m_k = (h/over) (Σ_i p_i B_i + h Σ_i q_i D_i).
template <DifferentiableLieOperations Lie>
void MagnusExponent<Lie>::form_moment(std::size_t k, double h) {
  const MagnusScheme::Moment& moment = scheme_.moments[k];
  const double part = h / moment.over;
  terms_.clear();
  for (const auto& p : moment.of_B) terms_.push_back({p.above * part / p.below, &B_[p.of]});
  for (const auto& q : moment.of_D) terms_.push_back({q.above * h * part / q.below, &D_[q.of]});
  lie_.combine(m_[k], terms_);
}

}  // namespace isosyrk

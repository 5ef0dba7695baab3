// What an equation in a Lie algebra is written with, whatever its matrices are stored in.
#pragma once

#include <concepts>
#include <functional>
#include <span>
#include <utility>

#include "isosyrk/linalg/adjoint_rotation.h"
#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The term weight X of a sum.
template <class M>
struct WeightedTerm {
  double weight;
  const M* X;
};

/// The operations of a Lie algebra with an operator B, for matrices of a type M.  Formulas that the
/// published and the fast form of a method share are written with them once, with their outputs
/// first:
///
///     lie.zero()                         returns 0
///     out = a * X + b * Y - Z            sums, of which out may be a term
///     lie.combine(out, terms)            out  = Σ weight X in this order; out may be the first X
///     lie.bracket(out, A, B, scale)      out  = scale [A, B]; out is neither A nor B
///     lie.add_bracket(out, A, B, scale)  out += scale [A, B]
///     lie.generate(out, W)               out  = B(W); out is not W
///     lie.cut(X)                         leaves out of X what is negligible, perhaps nothing
///
/// Brackets and generators are counted and allocate nothing.
template <class Lie>
concept LieOperations = requires(Lie lie, typename Lie::M& out, const typename Lie::M& X,
                                 std::span<const WeightedTerm<typename Lie::M>> terms) {
  { lie.zero() } -> std::same_as<typename Lie::M>;
  lie.combine(out, terms);
  lie.bracket(out, X, X);
  lie.bracket(out, X, X, 2.0);
  lie.add_bracket(out, X, X);
  lie.add_bracket(out, X, X, 2.0);
  lie.generate(out, X);
  lie.cut(out);
};

/// The same with the derivative of B along the flow:
///
///     lie.differentiate(out, W, k)       out = B'(W) k for k = [B(W), W]
template <class Lie>
concept DifferentiableLieOperations = LieOperations<Lie> &&
    requires(Lie lie, typename Lie::M& out, const typename Lie::M& X) {
  lie.differentiate(out, X, X);
};

/// LieOperations of the published forms: on matrices in storage, to rounding.
template <class Scalar>
class PublishedLie {
 public:
  using M = MatrixOf<Scalar>;
  using GeneratorFunction = std::function<void(const M& W, M& B)>;

  /// The algebra, what forms brackets and what B needs must outlive it.  Only the constructor
  /// allocates.
  PublishedLie(const QuadraticAlgebra& algebra, AdjointRotation<Scalar>& rotation,
               ProductsOf<Scalar>& products, GeneratorFunction generator)
      : algebra_(algebra),
        rotation_(rotation),
        products_(products),
        generator_(std::move(generator)),
        term_(zero()) {}

  M zero() const { return algebra_.zero<Scalar>(); }
  void combine(M& out, std::span<const WeightedTerm<M>> terms) {
    out = terms[0].weight * *terms[0].X;
    for (const auto& [weight, X] : terms.subspan(1)) out += weight * *X;
  }
  void bracket(M& out, const M& A, const M& B, double scale = 1.0) {
    rotation_.commutator(products_, A, B, out);
    if (scale != 1.0) out *= scale;
  }
  void add_bracket(M& out, const M& A, const M& B, double scale = 1.0) {
    bracket(term_, A, B, scale);
    out += term_;
  }
  void generate(M& B, const M& W) { generator_(W, B); }
  void cut(M&) {}

 private:
  const QuadraticAlgebra& algebra_;
  AdjointRotation<Scalar>& rotation_;
  ProductsOf<Scalar>& products_;
  GeneratorFunction generator_;
  M term_;  // a bracket to be added
};

}  // namespace isosyrk

#include "isosyrk/flows/split_laplacian.h"

#include <algorithm>

#include "isosyrk/split/split_blocks.h"

namespace isosyrk {

namespace {

// Where a share of the diagonals begins: a multiple of 8, so that they are taken by whole vectors.
Index first_diagonal(Index n, Index band, Index part, Index parts) {
  if (part == parts) return band + 1;
  const Index all = (band + 1) * (2 * n - band) / 2;
  Index m = 0;
  for (Index before = 0; parts * before < part * all; ++m) before += n - m;
  return std::min(m / 8 * 8, band + 1);
}

}  // namespace

Diagonals::Diagonals(Index n, Index band, Share share)
    : begin(first_diagonal(n, band, share.part, share.parts)),
      end(first_diagonal(n, band, share.part + 1, share.parts)) {}

template <class Real>
PlanarLaplacianOf<Real>::PlanarLaplacianOf(const Laplacian& laplacian)
    : n_(laplacian.size()),
      row_(planar_row<Real>(n_)),
      lower_(Reals::Zero(n_ * row_)),
      reciprocal_pivot_(Reals::Zero(n_ * row_)),
      no_factors_(Reals::Zero(4)),
      identity_solution_(laplacian.identity_solution().template cast<Real>()) {
  for (Index i = 0; i < n_; ++i) {
    for (Index m = 0; m < n_ - i; ++m) {
      lower_(i * row_ + m) = static_cast<Real>(laplacian.lower(i, m));
      reciprocal_pivot_(i * row_ + m) = static_cast<Real>(laplacian.reciprocal_pivot(i, m));
    }
  }
}

template <class Real>
void PlanarLaplacianOf<Real>::solve_skew_hermitian(const PlanarMatrixOf<Real>& W, Real scale,
                                                   PlanarMatrixOf<Real>& P, Index band) const {
  solve_upper(W, scale, P, band);
  mirror_skew_within(band, P);
}

template <class Real>
void PlanarLaplacianOf<Real>::solve_upper(const PlanarMatrixOf<Real>& W, Real scale,
                                          PlanarMatrixOf<Real>& P, Index band, Share share) const {
  // Every diagonal at once, four at a time; past the end of a row all factors are 0, and what is
  // written there, where the rows are filled up, must be too.
  const Index n = n_;
  const Index row = row_;
  const Index stride = W.stride();
  const Real* l = lower_.data();
  const Real* d = reciprocal_pivot_.data();
  const Real* w_re = W.re();
  const Real* w_im = W.im();
  Real* p_re = P.re();
  Real* p_im = P.im();
  const auto put = [=](Index at, Index left, Four<Real> re, Four<Real> im) {
    if (left < 4) {
      clear_from<Real>(left, re);
      clear_from<Real>(left, im);
    }
    four(p_re + at) = re;
    four(p_im + at) = im;
  };

  const Diagonals diagonals(n, band, share);
  const Index first = diagonals.begin;
  const auto end = [n, last = diagonals.end](Index i) { return std::min(n - i, last); };

  // Forward elimination: y_i = f_i - l_i y_{i-1}.
  std::copy(w_re + diagonals.begin, w_re + diagonals.end, p_re + diagonals.begin);
  std::copy(w_im + diagonals.begin, w_im + diagonals.end, p_im + diagonals.begin);
  for (Index i = 1; i < n; ++i) {
    const Index here = i * stride + i;
    const Index above = here - stride - 1;
    const Index behind = end(i);
    for (Index m = first; m < behind; m += 4) {
      const Four<Real> factor = four(l + i * row + m);
      const Four<Real> re = four(w_re + here + m) - factor * four(p_re + above + m);
      const Four<Real> im = four(w_im + here + m) - factor * four(p_im + above + m);
      put(here + m, behind - m, re, im);
    }
  }

  // Back substitution: x_i = y_i / d_i - l_{i+1} x_{i+1}, with Δ = -(L D Lᵀ).
  for (Index i = n - 1; i >= 0; --i) {
    const bool last_row = i == n - 1;
    const Index here = i * stride + i;
    const Index below = last_row ? here : here + stride + 1;
    const Real* l_below = last_row ? no_factors_.data() : l + (i + 1) * row;
    const Index behind = end(i);
    for (Index m = first; m < behind; m += 4) {
      const Four<Real> pivot = -scale * four(d + i * row + m);
      const Four<Real> factor = four(l_below + m);
      const Four<Real> re = pivot * four(p_re + here + m) - factor * four(p_re + below + m);
      const Four<Real> im = pivot * four(p_im + here + m) - factor * four(p_im + below + m);
      put(here + m, behind - m, re, im);
    }
  }

  if (share.is_first()) P.set_band(band);
  if (diagonals.begin > 0 || diagonals.end == 0) return;
  // The main diagonal: take out what the trace of W put in, then the trace.
  const auto diagonal = [stride](auto* part, Index i) -> auto& { return part[i * stride + i]; };
  Real mean_of_W = 0;
  for (Index i = 0; i < n_; ++i) mean_of_W += diagonal(W.im(), i);
  mean_of_W *= scale / static_cast<Real>(n_);
  Real mean = 0;
  for (Index i = 0; i < n_; ++i) {
    diagonal(P.im(), i) -= mean_of_W * identity_solution_(i);
    mean += diagonal(P.im(), i);
  }
  mean /= static_cast<Real>(n_);
  for (Index i = 0; i < n_; ++i) diagonal(P.im(), i) -= mean;
}

template class PlanarLaplacianOf<double>;
template class PlanarLaplacianOf<float>;

}  // namespace isosyrk

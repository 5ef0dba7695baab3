#include "isosyrk/flows/split_laplacian.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/flows/spin.h"
#include "isosyrk/split/small_blocks.h"

namespace isosyrk {
namespace {

// Returns the first diagonal of a part of the diagonals within a band, a multiple of 8, so that
// parts begin at whole vectors.  All parts hold about the same number of entries.
Index first_diagonal(Index n, Index band, Index part, Index parts) {
  if (part == parts) return band + 1;
  const Index all = (band + 1) * (2 * n - band) / 2;
  Index m = 0;
  for (Index before = 0; parts * before < part * all; ++m) before += n - m;
  return std::min(m / 8 * 8, band + 1);
}

// The part with l = 1 of a skew-Hermitian matrix: i of_z m_k on the diagonal, and of_ladder times
// the ladder of S beside it.
struct RotationPart {
  double of_z = 0.0;
  Complex of_ladder = 0.0;
};

// Reads the upper triangle of B.
template <class Real>
RotationPart rotation_part(const Spin& spin, const SplitMatrixOf<Real>& B) {
  const Index next = B.stride() + 1;  // from an entry to the next of its diagonal
  RotationPart part;
  for (Index i = 0; i < spin.n; ++i) part.of_z += spin.magnetic(i) * B.im()[i * next];
  for (Index i = 0; i + 1 < spin.n; ++i) {
    part.of_ladder += spin.ladder(i) * Complex(B.re()[i * next + 1], B.im()[i * next + 1]);
  }
  part.of_z /= spin.squared_norm();
  part.of_ladder /= 2.0 * spin.squared_norm();
  return part;
}

// Subtracts from the upper triangles of B_i their parts with l = 1.
template <class Real>
void subtract_rotation(std::span<SplitMatrixOf<Real>> B) {
  const Spin spin(B.front().size());
  for (SplitMatrixOf<Real>& Bi : B) {
    const Index next = Bi.stride() + 1;
    const auto [of_z, of_ladder] = rotation_part(spin, Bi);
    for (Index i = 0; i < spin.n; ++i) {
      Bi.im()[i * next] -= static_cast<Real>(of_z * spin.magnetic(i));
    }
    for (Index i = 0; i + 1 < spin.n; ++i) {
      Bi.re()[i * next + 1] -= static_cast<Real>(of_ladder.real() * spin.ladder(i));
      Bi.im()[i * next + 1] -= static_cast<Real>(of_ladder.imag() * spin.ladder(i));
    }
  }
}

}  // namespace

template <class Real>
SplitLaplacianOf<Real>::SplitLaplacianOf(const Laplacian& laplacian)
    : n_(laplacian.size()),
      row_(split_row<Real>(n_)),
      lower_(Reals::Zero(n_ * row_)),
      reciprocal_pivot_(Reals::Zero(n_ * row_)),
      no_factors_(Reals::Zero(lanes<Real>)),
      identity_solution_(laplacian.identity_solution().template cast<Real>()) {
  for (Index i = 0; i < n_; ++i) {
    for (Index m = 0; m < n_ - i; ++m) {
      lower_(i * row_ + m) = static_cast<Real>(laplacian.lower(i, m));
      reciprocal_pivot_(i * row_ + m) = static_cast<Real>(laplacian.reciprocal_pivot(i, m));
    }
  }
}

template <class Real>
void SplitLaplacianOf<Real>::solve_upper(std::span<const SplitMatrixOf<Real>> W, Real scale,
                                         Index band, std::span<SplitMatrixOf<Real>> P) const {
  parallel::for_shares_of(
      W, [&](std::size_t i, Share share) { solve_upper(W[i], scale, band, P[i], share); });
}

template <class Real>
void SplitLaplacianOf<Real>::solve_upper(const SplitMatrixOf<Real>& W, Real scale, Index band,
                                         SplitMatrixOf<Real>& P, Share share) const {
  // All diagonals at once, a few in each vector.  Past the end of a row the factors are 0, and
  // `put` writes zeros there, since the padding must stay 0.
  const Index n = n_;
  const Index row = row_;
  const Index stride = W.stride();
  const Real* l = lower_.data();
  const Real* d = reciprocal_pivot_.data();
  const Real* w_re = W.re();
  const Real* w_im = W.im();
  Real* p_re = P.re();
  Real* p_im = P.im();
  const auto put = [=](Index at, Index left, const Lanes<Real>& re, const Lanes<Real>& im) {
    Lanes<Real> kept_re = re;
    Lanes<Real> kept_im = im;
    if (left < lanes<Real>) {
      clear_from<Real>(left, kept_re);
      clear_from<Real>(left, kept_im);
    }
    store_lanes(p_re + at, kept_re);
    store_lanes(p_im + at, kept_im);
  };

  const Index first = first_diagonal(n, band, share.first, share.parts);
  const Index last = first_diagonal(n, band, share.end, share.parts);
  const auto end = [n, last](Index i) { return std::min(n - i, last); };

  // Forward elimination: y_i = f_i - l_i y_{i-1}.
  std::copy(w_re + first, w_re + last, p_re + first);
  std::copy(w_im + first, w_im + last, p_im + first);
  for (Index i = 1; i < n; ++i) {
    const Index here = i * stride + i;
    const Index above = here - stride - 1;
    const Index behind = end(i);
    for (Index m = first; m < behind; m += lanes<Real>) {
      const Lanes<Real> factor = load_lanes(l + i * row + m);
      const Lanes<Real> re = load_lanes(w_re + here + m) - factor * load_lanes(p_re + above + m);
      const Lanes<Real> im = load_lanes(w_im + here + m) - factor * load_lanes(p_im + above + m);
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
    for (Index m = first; m < behind; m += lanes<Real>) {
      const Lanes<Real> pivot = -scale * load_lanes(d + i * row + m);
      const Lanes<Real> factor = load_lanes(l_below + m);
      const Lanes<Real> re =
          pivot * load_lanes(p_re + here + m) - factor * load_lanes(p_re + below + m);
      const Lanes<Real> im =
          pivot * load_lanes(p_im + here + m) - factor * load_lanes(p_im + below + m);
      put(here + m, behind - m, re, im);
    }
  }

  if (share.is_first()) P.set_band(band);
  if (first > 0 || last == 0) return;
  // Main diagonal: subtract the contribution of the trace of W, then the trace of P.
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

template class SplitLaplacianOf<double>;
template class SplitLaplacianOf<float>;

SplitEulerZeitlin::SplitEulerZeitlin(const Laplacian& laplacian, double reciprocal_hbar,
                                     Rotation rotation)
    : n_(laplacian.size()),
      laplacian_(laplacian),
      single_laplacian_(laplacian),
      reciprocal_hbar_(reciprocal_hbar),
      rotation_(rotation) {}

// R = B(W_1) = -W_1 / (2ħ).  tr S_a² is the sum of m_k², and half the sum of the ladder's squares.
double SplitEulerZeitlin::rotation_left_out(const SplitMatrix& W) const {
  if (rotation_ == Rotation::kept) return 0.0;
  const Spin spin(n_);
  const auto [of_z, of_ladder] = rotation_part(spin, W);
  return 0.5 * reciprocal_hbar_ *
         std::sqrt(spin.squared_norm() * (of_z * of_z + 4.0 * std::norm(of_ladder)));
}

void SplitEulerZeitlin::upper_within(Index band, std::span<const SplitMatrix> W,
                                     std::span<SplitMatrix> B) const {
  laplacian_.solve_upper(W, reciprocal_hbar_, band, B);
  if (rotation_ == Rotation::left_out) subtract_rotation(B);
}

void SplitEulerZeitlin::upper_within(Index band, std::span<const SingleMatrix> W,
                                     std::span<SingleMatrix> B) const {
  single_laplacian_.solve_upper(W, static_cast<float>(reciprocal_hbar_), band, B);
  if (rotation_ == Rotation::left_out) subtract_rotation(B);
}

}  // namespace isosyrk

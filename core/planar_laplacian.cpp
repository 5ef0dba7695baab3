#include "core/planar_laplacian.h"

#include "core/planar_blocks.h"

namespace isosyrk {

PlanarLaplacian::PlanarLaplacian(const Laplacian& laplacian)
    : n_(laplacian.size()),
      stride_(planar_stride(n_)),
      lower_(RealVector::Zero(n_ * stride_)),
      reciprocal_pivot_(RealVector::Zero(n_ * stride_)),
      no_factors_(RealVector::Zero(4)),
      identity_solution_(laplacian.identity_solution()) {
  for (Index i = 0; i < n_; ++i) {
    for (Index m = 0; m < n_ - i; ++m) {
      lower_(i * stride_ + m) = laplacian.lower(i, m);
      reciprocal_pivot_(i * stride_ + m) = laplacian.reciprocal_pivot(i, m);
    }
  }
}

void PlanarLaplacian::solve_skew_hermitian(const PlanarMatrix& W, double scale,
                                           PlanarMatrix& P) const {
  // Every diagonal at once, four at a time; past the end of a row all factors are 0, and what is
  // written there, where the rows are filled up, must be too.
  const Index n = n_;
  const Index stride = stride_;
  const double* l = lower_.data();
  const double* d = reciprocal_pivot_.data();
  const double* w_re = W.re();
  const double* w_im = W.im();
  double* p_re = P.re();
  double* p_im = P.im();
  const auto put = [=](Index at, Index left, Four re, Four im) {
    if (left < 4) {
      clear_from(left, re);
      clear_from(left, im);
    }
    four(p_re + at) = re;
    four(p_im + at) = im;
  };

  // Forward elimination: y_i = f_i - l_i y_{i-1}.
  std::copy(w_re, w_re + stride, p_re);
  std::copy(w_im, w_im + stride, p_im);
  for (Index i = 1; i < n; ++i) {
    const Index here = i * stride + i;
    const Index above = here - stride - 1;
    for (Index m = 0; m < n - i; m += 4) {
      const Four factor = four(l + i * stride + m);
      const Four re = four(w_re + here + m) - factor * four(p_re + above + m);
      const Four im = four(w_im + here + m) - factor * four(p_im + above + m);
      put(here + m, n - i - m, re, im);
    }
  }

  // Back substitution: x_i = y_i / d_i - l_{i+1} x_{i+1}, with Δ = -(L D Lᵀ).
  for (Index i = n - 1; i >= 0; --i) {
    const bool last_row = i == n - 1;
    const Index here = i * stride + i;
    const Index below = last_row ? here : here + stride + 1;
    const double* l_below = last_row ? no_factors_.data() : l + (i + 1) * stride;
    for (Index m = 0; m < n - i; m += 4) {
      const Four pivot = -scale * four(d + i * stride + m);
      const Four factor = four(l_below + m);
      const Four re = pivot * four(p_re + here + m) - factor * four(p_re + below + m);
      const Four im = pivot * four(p_im + here + m) - factor * four(p_im + below + m);
      put(here + m, n - i - m, re, im);
    }
  }

  // The main diagonal: take out what the trace of W put in, then the trace.
  const auto diagonal = [this](auto* plane, Index i) -> auto& { return plane[i * stride_ + i]; };
  double mean_of_W = 0.0;
  for (Index i = 0; i < n_; ++i) mean_of_W += diagonal(W.im(), i);
  mean_of_W *= scale / static_cast<double>(n_);
  double mean = 0.0;
  for (Index i = 0; i < n_; ++i) {
    diagonal(P.im(), i) -= mean_of_W * identity_solution_(i);
    mean += diagonal(P.im(), i);
  }
  mean /= static_cast<double>(n_);
  for (Index i = 0; i < n_; ++i) diagonal(P.im(), i) -= mean;
  mirror_skew(P);
}

}  // namespace isosyrk

#include "isosyrk/split/mixed_sums.h"

#include "isosyrk/split/split_sums.h"

namespace isosyrk {

using mixed_sums::at;
using mixed_sums::Doubles;
using mixed_sums::for_pieces;

namespace {

template <int Size>
void form_residuals(const PlanarMatrix& base, double h, const RealMatrix& a,
                    const std::vector<PlanarMatrix>& Y, const std::vector<PlanarMatrix>& X,
                    std::vector<SingleMatrix>& R, double* squares, Share share) {
  constexpr int most = Size == Eigen::Dynamic ? max_stages : Size;
  const Eigen::Matrix<double, Size, Size, Eigen::ColMajor, most, most> c = h * a;
  Doubles sums[most];
  for (Index i = 0; i < c.rows(); ++i) sums[i].setZero();
  for_pieces(base.size(), share, [&](Index at_double, Index at_single) {
    Doubles y[most];
    for (Index j = 0; j < c.rows(); ++j) y[j] = at(Y[static_cast<std::size_t>(j)], at_double);
    const Doubles start = at(base, at_double);
    for (Index i = 0; i < c.rows(); ++i) {
      Doubles fresh = start;
      for (Index j = 0; j < c.rows(); ++j) fresh += c(i, j) * y[j];
      const Doubles change = fresh - at(X[static_cast<std::size_t>(i)], at_double);
      sums[i] += change.square();
      at(R[static_cast<std::size_t>(i)], at_single) = change.cast<float>();
    }
  });
  for (Index i = 0; i < c.rows(); ++i) squares[i] = sums[i].sum();
}

}  // namespace

void residuals(const PlanarMatrix& base, double h, const RealMatrix& a,
               const std::vector<PlanarMatrix>& Y, const std::vector<PlanarMatrix>& X,
               std::vector<SingleMatrix>& R, double* squares, Share share) {
  switch (Y.size()) {
    case 1:
      return form_residuals<1>(base, h, a, Y, X, R, squares, share);
    case 2:
      return form_residuals<2>(base, h, a, Y, X, R, squares, share);
    case 3:
      return form_residuals<3>(base, h, a, Y, X, R, squares, share);
    default:
      return form_residuals<Eigen::Dynamic>(base, h, a, Y, X, R, squares, share);
  }
}

double residual(const PlanarMatrix& base, double h, const RealMatrix& a, Index i,
                const std::vector<PlanarMatrix>& Y, const PlanarMatrix& X_i, SingleMatrix& R_i,
                Share share) {
  return residual(X_i, planar_sums::stage(base, h, a, i, Y), R_i, share);
}

void narrow(const PlanarMatrix& X, SingleMatrix& S, Share share) {
  for_pieces(X.size(), share, [&](Index i, Index k) { at(S, k) = at(X, i).cast<float>(); });
  if (share.is_first()) S.set_band(X.band());
}

void add(const SingleMatrix& S, PlanarMatrix& X, Share share) {
  for_pieces(X.size(), share, [&](Index i, Index k) { at(X, i) += at(S, k).cast<double>(); });
}

}  // namespace isosyrk

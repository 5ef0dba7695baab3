// The inverse Laplacian, and the generator of Euler-Zeitlin, in split-complex storage.
#pragma once

#include "isosyrk/flows/laplacian.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/split/parallel.h"

namespace isosyrk {

/// Laplacian::solve_skew_hermitian in split-complex storage, with the same factors.  Reads the
/// upper triangle of W and the imaginary part of its diagonal.
template <class Real>
class SplitLaplacianOf {
 public:
  explicit SplitLaplacianOf(const Laplacian& laplacian);

  /// Sets the upper triangles of P_i = scale Δ⁻¹ W_i within a band, trace-free.  Fewer than
  /// `lanes` entries of a row beyond the band become 0; other entries of P_i are unchanged.  P_i is
  /// not W_i.  Allocates nothing.
  void solve_upper(std::span<const SplitMatrixOf<Real>> W, Real scale, Index band,
                   std::span<SplitMatrixOf<Real>> P) const;

 private:
  using Reals = typename SplitMatrixOf<Real>::Entries;

  void solve_upper(const SplitMatrixOf<Real>& W, Real scale, Index band, SplitMatrixOf<Real>& P,
                   Share share) const;

  Index n_;
  Index row_;
  // The factors of row i and diagonal m stand at i row_ + m, m = 0 .. n-1-i, followed by zeros.
  Reals lower_;
  Reals reciprocal_pivot_;
  Reals no_factors_;  // zeros, for the row below the last
  Reals identity_solution_;
};

/// Whether B has its part with l = 1, a rigid rotation.
enum class Rotation { kept, left_out };

/// The generator B(W) = Δ⁻¹ W / ħ of Euler-Zeitlin, or B(W - W_1), in double and single precision.
class SplitEulerZeitlin final : public SplitGenerator {
 public:
  SplitEulerZeitlin(const Laplacian& laplacian, double reciprocal_hbar,
                    Rotation rotation = Rotation::kept);

  void upper_within(Index band, std::span<const SplitMatrix> W,
                    std::span<SplitMatrix> B) const override;
  void upper_within(Index band, std::span<const SingleMatrix> W,
                    std::span<SingleMatrix> B) const override;
  double rotation_left_out(const SplitMatrix& W) const override;
  /// Returns 1/(l(l+1)ħ) for the least l that is left: 1 or 2.
  double norm_bound() const override {
    return reciprocal_hbar_ / (rotation_ == Rotation::kept ? 2.0 : 6.0);
  }
  bool damps_fine_scales() const override { return true; }

 private:
  Index n_;
  SplitLaplacianOf<double> laplacian_;
  SplitLaplacianOf<float> single_laplacian_;
  double reciprocal_hbar_;
  Rotation rotation_;
};

}  // namespace isosyrk

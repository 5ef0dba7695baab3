// The exponential Lie-Poisson methods in split-complex storage.
#pragma once

#include <array>
#include <span>
#include <utility>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/graded_gradient.h"
#include "isosyrk/fast/graded_series.h"
#include "isosyrk/fast/split_exponential.h"
#include "isosyrk/fast/split_magnus.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/fast/start_error.h"
#include "isosyrk/solver/neumann_correction.h"

namespace isosyrk {

/// ExponentialLiePoisson of order 2, 4 or 6 for J = I, with the unknown Ω:
///
///     Ω  = G(Ω) = h B̃(μ),   μ = φ₁(ad_Ω) W₀ = Σ_k T_k / (k+1),   W₁ = e^Ω W₀ e^(-Ω)
///
/// with T_k of GradedSeries and B̃ of GradedGradient.  Tolerance and accuracy are relative to ‖Ω‖_F,
/// or to more as in the published form (integrators/unit_of_exponent.h).  A step is isospectral for
/// any Ω, and Lie-Poisson to the tolerance.
///
/// The Jacobian is K + E.  K is the coupling of B alone: with c₀ = δ, c_j = [Ω, c_{j-1}] / (j+1),
/// and e^{s ad_Ω} W₀ from the same series as μ,
///
///     K δ = h B(D),   D = ∫₀¹ [s Σ_j s^j c_j, e^{s ad_Ω} W₀] ds
///
/// by Gauss quadrature of weight s: one node, s = 2/3, or two, (6 ∓ √6)/10, where more digits are
/// wanted.  The step before tells whether they will be; where it does not, the estimated error says
/// that one node was too few.  E δ = h³ (∇F₂)'(μ) D is the derivative of the term of B̃ in h², about
/// as small beside δ as the term beside B.  It is taken where it shows; what is left out of it, and
/// the derivative of the term in h⁴, enter the estimated error.
///
/// The error of explicit start values is foretold from that of the step before (StartError).
///
/// Products of a residual: 1 for each T_k, in double precision only where it has to be, and those
/// of B̃ - B.  In single precision, of K δ: 1 for each c_j and 1 for each node; of E δ: 6.
/// Of the update: those of SplitExponential.  Of an explicit start: 6 for magnus4 and 12 for
/// magnus5 in single precision, and 1.5 to carry its error.  Poisson solves: those of B̃, 1 for K δ,
/// 3 for E δ.
class ExponentialSystem final : public StageSystem, private Coupling {
 public:
  /// Bands are truncated if options.bands is true.  Throws std::invalid_argument for a flow without
  /// a generator in split-complex storage, and for threads out of range.
  ExponentialSystem(const Flow& flow, int order, const FastOptions& options = {});

  Unknowns unknowns() const override { return {split_stages(1, n_)}; }
  /// Newton from past steps, from an explicit step and from a cold start; then Picard and Anderson.
  std::vector<Attempt> attempts(bool newton) const override;
  void forget() override;
  // The change of the step before the last is not read again: bind() takes that of the last.
  void exchange_memory() override {
    std::swap(largest_change_, other_.largest_change);
    gradient_.exchange_memory(other_.gradient);
    std::swap(derivative_per_share_, other_.derivative_per_share);
    std::swap(start_error_, other_.start_error);
    exponential_.exchange(other_.adjoint);
  }
  void bind(const SplitMatrix& W0, double h, double tolerance) override;
  /// Explicit: Ω of magnus4, or of magnus5 for order 6, less its expected error.  Cold: Ω = h
  /// B(W₀).
  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) override;
  double unit(const Unknowns& x) const override;
  double least_contraction() const override { return least_contraction_; }
  Acceptance acceptance() const override { return acceptance_; }
  /// W1 is not finite where ‖Ω‖ is beyond SplitExponential.
  void update(SplitMatrix& W1, const Unknowns& x) override;

  bool truncates() const override { return bands_.enabled(); }
  void truncate(bool enabled) override { bands_.enable(enabled); }
  Work work() const override { return work_of(products_, single_products_, generator_); }

 private:
  static constexpr std::size_t most_nodes = 2;

  // What the Jacobian is formed from and in.
  struct Linearization {
    explicit Linearization(Index n);

    // Of the last residual.
    std::array<SingleMatrix, 3> moved;  // e^{s ad_Ω} W₀ at s = 2/3 and, if has_pair_, at both nodes

    // Of the coupling.
    SingleMatrix Omega;
    SingleMatrix c, next_c;                      // c_j and c_{j+1}
    std::array<SingleMatrix, most_nodes> inner;  // Σ_j s^j c_j at the nodes
    SingleMatrix D, sum_of_D;
    SingleMatrix BD;  // B(D), or B of the sum
  };

  void couple(Corrections& coupled, const Corrections& delta, double accuracy) override;
  static bool needs_pair(double size, double error);
  double error_of_two_nodes(double size_of_Omega) const;
  void choose_nodes();
  void start_cold(SplitMatrix& Omega);
  double moved_error(double part) const;
  // e^{s ad_Ω} W₀ at the nodes that were chosen.
  std::span<SingleMatrix> moved_in_use() {
    return {at_.moved.data(), has_pair_ ? at_.moved.size() : 1};
  }
  bool form_average(const SplitMatrix& Omega, double error);
  double error_of_average(double accuracy, const Unknowns& x) const;
  void cut(double part);
  Correction solve(Corrections& delta, const Corrections& R, const CorrectionRequest& request,
                   double derivative, const IterationOptions& options);
  void couple(SingleMatrix& coupled, const SingleMatrix& delta, double accuracy);
  void differentiate(double part);

  Index n_;
  int order_;
  Acceptance acceptance_;
  bool starts_explicitly_;
  bool is_graded_;
  SplitProducts products_;
  SingleProducts single_products_;
  StageGenerator generator_;
  BandTruncation bands_;
  SplitLie<double> lie_;
  SplitLie<float> single_lie_;
  GradedSeries series_;
  GradedGradient gradient_;
  SplitMagnus<float> magnus_;
  SplitExponential exponential_;
  StartError start_error_;
  NeumannCorrection correction_;

  // Of the step.
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
  double tolerance_ = 0.0;
  double size_of_W0_ = 0.0;
  double rotation_ = 0.0;    // ‖hR‖_F of the rotation R that B is left without
  double least_unit_ = 0.0;  // least_unit_of_exponent()
  double least_contraction_ = 0.0;
  SingleMatrix W0_single_;

  // Of the last residual.
  SplitMatrix mu_;  // μ
  SplitMatrix v_;   // B̃(μ)
  // Largest relative change of a sweep, in this step and in the one before; 0 if unknown.
  double largest_change_ = 0.0;
  double change_before_ = 0.0;
  bool has_pair_ = true;         // e^{s ad_Ω} W₀ is formed at the two nodes too
  double error_of_moved_ = 0.0;  // allowed in it
  bool is_first_correction_ = true;

  Linearization at_;

  // Of a correction.
  // ‖E δ‖ / ‖δ‖ over the share of the term in h², as last seen.
  double derivative_per_share_;
  bool sums_D_ = false;  // D is summed over the couplings, for E δ
  bool has_sum_of_D_ = false;
  Corrections E_delta_;
  Corrections more_delta_;  // δ_k

  // Of the update.
  SplitMatrix Omega_cut_;  // Ω, cut to its band

  // What steps leave to later ones, for other steps: see the members of the same names.
  struct Memory {
    explicit Memory(Index n) : start_error(n), adjoint(n) {}

    double largest_change = 0.0;
    GradedGradient::Memory gradient;
    double derivative_per_share = 0.0;
    StartError start_error;
    SplitMatrix adjoint;  // of exponential_, which carries the error
  };
  Memory other_ = Memory(n_);
};

}  // namespace isosyrk

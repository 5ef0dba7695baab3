// Explicit methods in split-complex storage.
#pragma once

#include <optional>

#include "isosyrk/fast/graded_series.h"
#include "isosyrk/fast/split_exponential.h"
#include "isosyrk/fast/split_integrator.h"
#include "isosyrk/fast/split_lie.h"
#include "isosyrk/fast/stage_generator.h"
#include "isosyrk/integrators/magnus_exponent.h"
#include "isosyrk/integrators/past_slopes.h"
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/multistep_schemes.h"

namespace isosyrk {

/// What the explicit methods share: their operations in split-complex storage, for J = I.
class FastExplicit : public SplitIntegrator {
 protected:
  /// Throws std::invalid_argument for a flow without a generator in split-complex storage, and for
  /// threads out of range.  Bands are truncated if options.bands is true.
  FastExplicit(const SharedFlow& flow, const FastOptions& options);

  /// Computes W1 from W0, single matrices.  Returns false if the step diverges.
  virtual bool take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                                  StepMemory& memory) = 0;

  Generators generators() const { return generator_.generators(1); }
  SplitStages zeros(Index count) const { return split_stages(count, flow().size()); }
  /// out = scale [A, X] for skew-Hermitian A and X, by one product.
  void commutator(SplitStages& out, const SplitMatrix& A, const SplitMatrix& X, double scale = 1.0);
  /// B = B(W).  W is cut to its band.
  void generate(Generators& B, SplitStages& W) { generate(B, W, left_out_, left_out_); }
  /// The same with the Frobenius norms that may be cut from W and from hB.
  void generate(Generators& B, SplitStages& W, double of_W, double of_hB);
  BandTruncation& bands() { return bands_; }
  /// Frobenius norm that may be cut from W, which has about norm 1; of Ω the part of its norm.
  double left_out() const { return left_out_; }

  StepReport take_step(SplitStages& W1, const SplitStages& W0, double h,
                       StepMemory& memory) override;

  SplitProducts products_;
  SingleProducts single_products_;
  StageGenerator generator_;

 private:
  Work work() const final { return work_of(products_, single_products_, generator_); }
  void archive_work(StateArchive& run) final { run.pass(products_, single_products_, generator_); }

  BandTruncation bands_;
  double h_ = 0.0;
  double left_out_;
  SplitStages product_;  // A X
};

/// ExplicitRungeKutta to rounding: k_i = [B(W_i), W_i] with W_i = W₀ + h Σ_j a_ij k_j, and
/// W₁ = W₀ + h Σ_i b_i k_i.  Products: s.  Poisson solves: s.
class FastRungeKutta : public FastExplicit {
 public:
  /// Throws std::invalid_argument unless the tableau is consistent and explicit.
  FastRungeKutta(const SharedFlow& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  bool take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                          StepMemory& memory) override;

  /// k = [B(W), W].  W is cut to its band.
  void slope(SplitMatrix& k, SplitStages& W);
  /// Returns k_1 of the last step.
  const SplitMatrix& first_slope() const { return k_[0]; }

 private:
  Tableau tableau_;
  SplitStages W_stage_;  // W_i
  Generators B_;         // B(W_i)
  SplitStages slope_;    // k_i
  SplitStages k_;        // k_1 ... k_s
};

/// AdamsBashforthMoulton to rounding.  Products: 2; of a step of the start, those of
/// FastRungeKutta.  Poisson solves: the same.
class FastMultistep final : public FastRungeKutta {
 public:
  /// Throws as FastRungeKutta for the tableau of the start.
  FastMultistep(const SharedFlow& flow, const MultistepScheme& scheme, const FastOptions& options);

 private:
  // What a step leaves to the next one.
  struct Memory final : StepMemory {
    void forget() override {
      if (past) past->forget();
    }
    void archive(StateArchive& state) override {
      if (past) state.pass(*past);
    }

    std::optional<PastSlopes<SplitMatrix>> past;  // none beside a run, where no step follows
  };

  bool take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                          StepMemory& memory) override;
  void amended() override { memory_of_run<Memory>().forget(); }

  MultistepScheme scheme_;
  SplitStages predicted_;        // W₀, and then W̃
  SplitStages predicted_slope_;  // f̃
};

/// MuntheKaas4, with the exponents of MuntheKaasScheme.  The three series of the stages are summed
/// to what the error of the step can use, the last one to rounding: so the spectrum does not depend
/// on the accuracy of the stages.
///
/// **Accuracy of the stages.**  The error of a step, relative to ‖W‖_F, is estimated without a
/// product from its last stage W₄ = Ad(k₃) W₀,
///
///     e = 3 (‖W₁ - W₄‖_F / ‖W₀‖_F)^{5/3},
///
/// of order h⁵ since W₄ errs by O(h³).  Measured, e is 0.1 to 1 times the error (Euler-Zeitlin, in
/// the frame, smooth and rough, n = 17 to 129, h = 0.06 to 0.8).  Stages are then summed to
/// `stage_share` e ‖W₀‖_F with the e of the last step of the run, if that had the same |h|.
/// That moves W₁ by less than 1 % of its error, since B damps the terms left out.  A step whose own
/// e turns out smaller than a third of that is taken again with its own e.  In the first step, and
/// where it is larger, the accuracy is the tolerance, relative to ‖W‖_F: as for FastMagnus, the
/// tolerance is the working accuracy of what does not touch the spectrum.
///
/// Products: 2, 1 for each term of the 3 series, and those of SplitExponential; if ‖Ω‖ is beyond
/// that, 1 for each term of a fourth series.  Poisson solves: 4.
class FastMuntheKaas4 final : public FastExplicit {
 public:
  FastMuntheKaas4(const SharedFlow& flow, const FastOptions& options);

 private:
  // What a step leaves to the next one.
  struct Memory final : StepMemory {
    void forget() override { h.reset(); }
    void archive(StateArchive& state) override { state.pass(h, error); }

    std::optional<double> h;  // |h|
    double error = 0.0;       // e
  };

  StepReport take_step(SplitStages& W1, const SplitStages& W0, double h,
                       StepMemory& memory) override;
  bool take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                          StepMemory& memory) override;
  void form_exponent(std::size_t stage);
  void set_stage_error(double error);
  bool conjugate(SplitMatrix& W1, const SplitMatrix& W0, double error_of_U);

  MuntheKaasScheme scheme_;
  double tolerance_;
  GradedSeries series_;
  SplitExponential exponential_;
  SplitStages Omega_;         // Ω_i, and at the end Ω
  SplitMatrix adjoint_;       // U†
  SplitStages commutator_;    // of Ω_i
  SplitStages W_stage_;       // Ad(Ω_i) W₀
  Generators B_;              // B(Ad(Ω_i) W₀)
  SplitStages k_;             // k_1 ... k_4
  double scale_ = 0.0;        // ‖W₀‖_F
  double stage_error_ = 0.0;  // Frobenius norm that the series of a stage may leave out
  double error_ = 0.0;        // e of the step just taken
};

/// ExplicitMagnus: W₁ = e^Ω W₀ e^(-Ω) to rounding, with Ω to the tolerance, relative to ‖Ω‖: in
/// single precision if that is enough.  So the spectrum does not depend on the tolerance.
/// Products: those of MagnusExponent and of SplitExponential.
class FastMagnus final : public FastExplicit {
 public:
  FastMagnus(const SharedFlow& flow, const MagnusScheme& scheme, const FastOptions& options);

 private:
  bool take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                          StepMemory& memory) override;

  bool is_single_;
  SplitLie<double> lie_;
  SplitLie<float> single_lie_;
  // One of the two is made.
  std::optional<MagnusExponent<SplitLie<double>>> exponent_;
  std::optional<MagnusExponent<SplitLie<float>>> single_exponent_;
  SplitExponential exponential_;
  SplitMatrix Omega_;
  SplitMatrix adjoint_;  // U†, U = e^Ω
  SingleMatrix Omega_single_, W0_single_;
};

}  // namespace isosyrk

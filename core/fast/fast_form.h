// What the fast forms share: planar storage, start values from earlier steps, and a restart.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "isosyrk/solver/anderson.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/split/split_blocks.h"
#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/split_products.h"
#include "isosyrk/split/split_sums.h"
#include "isosyrk/solver/predictor.h"
#include "isosyrk/split/team.h"

namespace isosyrk {

class EulerZeitlin;

/// 16, 24 for n = 48 ... 191, and 12 from there on, where more save less than it costs to read them
/// (measured).
int default_start_order(Index n);

struct FastOptions {
  SolverOptions solver;
  /// Past steps that start values are predicted from; 0: every step starts cold.  By default
  /// default_start_order(n).
  std::optional<int> start_order = {};
  /// Whether their weights are fitted to how past steps followed from each other; else those of the
  /// polynomial through them (start_values.h).
  bool fit_start = true;
  /// Whether what a sweep leaves is corrected in single precision before the next one.  Without, 50
  /// steps take 0.8 to 1.2 times as long at n = 17 and 33 and 1.0 to 1.5 at 65 (measured), and in
  /// long runs sweeps creep up.
  bool correct = true;
  /// Whether sweeps that are not corrected are accelerated (Anderson).
  bool accelerate = false;
  /// Whether products leave out what lies so far off the diagonal that it does not count.  By
  /// default for n >= 48, where it pays; in a smooth scene only, in a rough one there is no such
  /// thing.
  std::optional<bool> bands = {};
  /// 1 or 2: a sweep's products, and most of what is between them, are shared out; below n = 48,
  /// with one stage below 96, where that costs more than it saves, one thread does all.  The
  /// results are the same bit for bit.
  int threads = 1;
};

/// A one-step method in planar matrices for Euler-Zeitlin on su(n): the answer of the published
/// form to the solver's tolerance, sooner.
///
/// Every iteration starts from predicted unknowns and stops by the rule of picard.h, on the
/// change that a plain sweep in double precision makes, so that what is accepted is as good as from
/// a cold start.
///
/// In between it is Newton's method, inexactly: with x the unknowns, G(x) what a sweep makes of
/// them and R = G(x) - x, the correction δ solves
///
///     δ = R + T δ + K δ
///
/// where T + K is the derivative of G, T with B held and K through B.  T contracts slowly, in the
/// fine scales, and K fast, since Δ⁻¹ keeps them out of B.  R is formed in double precision and all
/// else in single: it takes digits off R, and never decides that x is accepted.  Where a plain
/// sweep should do, by its contraction as last seen, there is none.
///
/// Bands: |r - c| <= m holds all modes up to degree m, so the matrices of a smooth state fall off
/// away from the diagonal.  Of B(W̃) what lies outside the smallest band that leaves h‖.‖ under a
/// hundredth of the tolerance is taken as 0, and likewise of other factors as each form says.  B
/// stays skew-Hermitian and every step isospectral; a full sweep still changes what is accepted by
/// no more than the tolerance and a hundredth of it.
///
/// Where the iteration fails it is tried cold, then cold by plain sweeps, then by those with
/// acceleration where it had none or without where it had, and only then has the step failed.
/// After a failed step, for a step of another size, and from another state than the last step ended
/// at, it starts cold.
class FastForm : public Integrator {
 public:
  using Singles = std::vector<SingleMatrix>;
  using SingleUnknowns = std::vector<Singles>;

  /// The change that one more sweep makes to the unknowns with which the last step, of size h, was
  /// accepted: what the tolerance bounds, seen from outside the solver.
  double change_of_one_more_sweep(double h);

  /// What FastOptions said, or the default.
  bool corrects() const { return options_.correct; }
  bool cuts() const { return cuts_; }
  /// As many of the threads asked for as pay.
  int threads() const { return team_.threads(); }

 protected:
  /// What one of the threads works with.
  struct Worker {
    PlanarProducts planar;
    SingleProducts singles;
    long solves = 0;
  };

  /// With so many unknowns of each kind.  K acts through so many diagonals at least, and through
  /// those of B in single precision; Δ⁻¹ takes from those further out what they could add.  With
  /// fewer, a smooth scene needs a third sweep (measured).
  FastForm(const EulerZeitlin& flow, const FastOptions& options,
           std::initializer_list<Items> unknowns, Index least_coupling_band);

  StepReport advance(const Matrix& W0, double h, Matrix& W1) final;

  /// Sees W0_ before anything else of a step.
  virtual void begin_step() {}
  /// Sets the unknowns for a cold start.
  virtual void start_cold() = 0;
  /// Computes what follows from the unknowns where it is not the last sweep that set them.
  virtual void begin() {}
  /// As of solve_fixed_point.
  virtual double sweep(double h) = 0;

  /// R into residuals_, from a sweep that leaves the unknowns; returns the largest, as sweep().
  virtual double residual(double h) = 0;
  /// Takes what T and K are made of from the last residual, of B only what counts to a relative
  /// accuracy, and δ = R by start_correction; returns the widest band of B.
  virtual Index linearise(double h, double accuracy) = 0;
  /// δ = rhs + T δ; returns the largest change.
  virtual double transport(double h) = 0;
  /// Whether transport() solves that equation instead, to the accuracy asked of linearise().
  virtual bool solves_transport() const { return false; }
  /// next_rhs_ = R + K δ, and into δ what that changes by shift(); returns the largest change.
  virtual double couple(double h) = 0;
  /// W₁ from the last sweep.
  virtual void update(double h, PlanarMatrix& W1) = 0;

  /// B = B(W) within its band, counted; of W the upper triangle is read.  Two phases of an item,
  /// in all of which it is the same.
  void solve_generator(std::size_t item, const PlanarMatrix& W, PlanarMatrix& B, Share share,
                       Worker& worker);
  void finish_generator(std::size_t item, PlanarMatrix& B, Share share) const;

  /// δ = R, and that is the right-hand side too.
  void start_correction(std::size_t kind, std::size_t item, Share share) {
    reals(delta_[kind][item], share) = reals(rhs_[kind][item], share) =
        reals(residuals_[kind][item], share);
  }
  /// δ into `moved`, which may be δ, as next_rhs_ changes it; its square is what that changes.
  void shift(std::size_t kind, std::size_t item, SingleMatrix& moved, Share share);
  /// The same with next_rhs_ = R + product, the K δ of the item; `moved` may be the product too.
  void couple_with(std::size_t kind, std::size_t item, const SingleMatrix& product,
                   SingleMatrix& moved, Share share);

  Index coupling_band() const { return coupling_band_; }
  static Index widest_band(const Singles& matrices);
  /// δB = B(δW̃) within it, likewise.
  void solve_generator(const SingleMatrix& W, SingleMatrix& B, Share share, Worker& worker) const;
  void finish_generator(SingleMatrix& B, Share share) const;
  /// S = B rounded, without what comes to less than h‖.‖ = accuracy.
  void narrow_generator(std::size_t item, const PlanarMatrix& B, double h, double accuracy,
                        SingleMatrix& S, Share share) const;

  /// Cuts X to the band that holds all but `tail` of it: two phases of an item.
  template <class AnyMatrix>
  void measure(std::size_t item, const AnyMatrix& X, Share share) {
    if (!cuts_) return;
    for_halves(share, [&](Share half) {
      diagonal_squares(X, row_squares_[item][static_cast<std::size_t>(half.part)], half);
    });
  }
  template <class AnyMatrix>
  void cut(std::size_t item, double tail, AnyMatrix& X, Share share) const {
    const auto& squares = row_squares_[item];
    cut_to_band(cuts_ ? smallest_band(squares[0] + squares[1], tail) : X.size() - 1, X, share);
  }
  /// What may be left out: a hundredth of the tolerance.
  double left_out() const;

  /// Calls each phase(item, share, worker) for all items, as Team::run_phases.
  template <class... Phases>
  void in_phases(Items items, Phases&&... phases) {
    team_.run_phases(items, with_workers(phases)...);
  }

  /// Calls half(item, share) for both halves of all items.
  template <class OfHalf>
  void in_halves_of(Items items, OfHalf&& half) {
    team_.run_halves(items, [&](std::size_t item, Share share, std::size_t) { half(item, share); });
  }

  /// Calls half(kind, item, share) for both halves of all unknowns.
  template <class OfHalf>
  void in_halves_of_unknowns(OfHalf&& half) {
    in_halves_of(all_items_, [&](std::size_t place, Share share) {
      half(order_[place].first, order_[place].second, share);
    });
  }

  /// Calls half(share) for both halves of something.
  template <class OfHalf>
  void in_halves(OfHalf&& half) {
    in_halves_of(1, [&](std::size_t, Share share) { half(share); });
  }

  /// X_i = base_i + h Σ_j a_ij Y_j, as update_unknowns of stage_sums.h and shared out, and each
  /// phase(i, share, worker) of all i after it; returns the largest change.  Base is one matrix or
  /// a vector of one for each.
  template <class Base, class AnyMatrix, class... Phases>
  double update_stages(const Base& base, double h, const RealMatrix& a,
                       const std::vector<AnyMatrix>& Y, std::vector<AnyMatrix>& X,
                       Phases&&... phases) {
    if (each_has_its_own(X.size())) {
      in_phases(
          X.size(),
          [&](std::size_t i, Share share, Worker&) {
            for_halves(share, [&](Share half) {
              half_of_squares(half)[i] =
                  update_unknown(base, h, a, static_cast<Index>(i), Y, X[i], half);
            });
          },
          phases...);
    } else {
      in_halves([&](Share half) {
        const NumbersOfRows numbers(X[0], half);
        update_unknowns(base, h, a, Y, X, half_of_squares(half), numbers.begin, numbers.end);
      });
      if constexpr (sizeof...(phases) > 0) in_phases(X.size(), phases...);
    }
    return largest_of_squares(static_cast<Index>(X.size()));
  }
  /// The unknowns of a kind by that, each then cut to the band that holds all but left_out() of it;
  /// returns the largest change, without what is cut.
  double update_and_cut(std::size_t kind, const PlanarMatrix& base, double h, const RealMatrix& a,
                        const std::vector<PlanarMatrix>& Y);
  /// The same of the unknowns as they stand.
  void cut_unknowns(std::size_t kind);
  /// R_i = base + h Σ_j a_ij Y_j - X_i, likewise; returns the largest.
  double residuals_of_stages(const PlanarMatrix& base, double h, const RealMatrix& a,
                             const std::vector<PlanarMatrix>& Y, const std::vector<PlanarMatrix>& X,
                             std::vector<SingleMatrix>& R);
  /// Where the squares of one half of what is summed go, to be read by largest_of_squares.
  double* half_of_squares(Share half) {
    return squares_[static_cast<std::size_t>(half.part)].data();
  }
  double largest_of_squares(Index count) const;

  /// Of some places to work in, one for each item that is under way at a time, that of this one.
  std::size_t place(std::size_t item) const { return team_.threads() == 1 ? 0 : item; }
  Index places(Index count) const { return team_.threads() == 1 ? 1 : count; }

  /// |h| of the step under way.
  double step() const { return step_; }

  PlanarMatrix zero() const { return PlanarMatrix(W0_.size()); }
  PlanarMatrix identity() const;
  std::vector<PlanarMatrix> zeros(Index count) const {
    return std::vector<PlanarMatrix>(static_cast<std::size_t>(count), zero());
  }
  /// As many in single precision, none where nothing is corrected.
  Singles singles(Index count) const {
    return Singles(static_cast<std::size_t>(corrects() ? count : 0), SingleMatrix(W0_.size()));
  }

  PlanarMatrix W0_;
  Unknowns unknowns_;
  SingleUnknowns residuals_, delta_, rhs_, next_rhs_;

 private:
  enum class Iteration { plain, accelerated, corrected };

  SolveReport iterate(double h, Iteration iteration);
  bool correct(double h, double change);
  void add_correction(const SingleUnknowns& correction);
  bool predict(double h);
  std::size_t number(std::size_t kind, std::size_t item) const;
  void measure_unknown(std::size_t kind, std::size_t i, Share share) {
    measure(number(kind, i), unknowns_[kind][i], share);
  }
  void cut_unknown(std::size_t kind, std::size_t i, Share share) {
    cut(number(kind, i), left_out(), unknowns_[kind][i], share);
  }

  SolveReport solve(double h, Attempt& attempt);

  // A phase(item, share, worker) for Team.
  template <class Phase>
  auto with_workers(Phase& phase) {
    return [&](std::size_t item, Share share, std::size_t thread) {
      phase(item, share, workers_[thread]);
    };
  }
  template <class Phase>
  auto with_workers(Undivided<Phase>& phase) {
    return undivided(phase.thread, with_workers(phase.phase));
  }

  // Whether two threads have as many of these, so that what one made of its own the other has not
  // to fetch; else halves of all are fewer passes over memory.
  bool each_has_its_own(Items items) const { return team_.threads() == 2 && items.halved == 0; }

  long products() const;
  double equivalent_products() const;
  long poisson_solves() const;

  FastOptions options_;
  std::vector<std::pair<std::size_t, std::size_t>> order_;  // (kind, item), for all_items_
  Items all_items_;
  Team team_;
  std::vector<Worker> workers_;
  PlanarLaplacian laplacian_;
  SingleLaplacian single_laplacian_;
  double reciprocal_hbar_;
  PlanarMatrix W1_;
  StartValues start_values_;
  Anderson anderson_;
  bool cuts_;
  Index least_coupling_band_;
  double contraction_ = 0.0;  // of a plain sweep close to the solution, as last seen
  Index coupling_band_ = 0;   // of the correction under way
  double step_ = 0.0;         // |h| of the step under way
  std::array<RealVector, 2> squares_;
  // By diagonals, of each item: of its generator, and of the halves of what is cut.
  std::vector<RealVector> generator_squares_;
  std::vector<std::array<RealVector, 2>> row_squares_;
};

}  // namespace isosyrk

// What the fast forms share: planar storage, start values from earlier steps, and a restart.
#pragma once

#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "core/anderson.h"
#include "core/integrator.h"
#include "core/planar_laplacian.h"
#include "core/planar_products.h"
#include "core/start_values.h"
#include "core/team.h"

namespace isosyrk {

class EulerZeitlin;

/// 10, and 9 from n = 96 on: the fastest for most cells of Table 1 (measured).  A higher order errs
/// less by itself but amplifies the rounding of past steps, which grows with n.
int default_start_order(Index n);

struct FastOptions {
  SolverOptions solver;
  /// Past steps that start values are extrapolated from; 0: every step starts cold.  By default
  /// default_start_order(n).
  std::optional<int> start_order = {};
  /// Whether sweeps are accelerated (Anderson).  By default with one stage and n >= 32, where it
  /// pays: with more stages it saves a twentieth of the sweeps, for more than that of their time.
  std::optional<bool> accelerate = {};
  /// Whether a sweep of group transports twice.  By default from n = 48 on, where it pays.
  std::optional<bool> transport_twice = {};
  /// 1 or 2: a sweep's products, and most of what is between them, are shared out; below n = 48,
  /// where that costs more than it saves, one thread does all.  The results are the same bit for
  /// bit.
  int threads = 1;
};

/// A one-step method in planar matrices for Euler-Zeitlin on su(n): the answer of the published
/// form to the solver's tolerance, sooner.
///
/// Every iteration starts from extrapolated unknowns and stops by the rule of fixed_point.h, on the
/// change that a plain sweep makes, so that what is accepted is as good as from a cold start. Where
/// it fails from there it is tried cold, then cold with acceleration where it had none or without
/// where it had, and only then has the step failed.  After a failed step, for a step of another
/// size, and from another state than the last step ended at, it starts cold.
class FastForm : public Integrator {
 public:
  /// The change that one more sweep makes to the unknowns with which the last step, of size h, was
  /// accepted: what the tolerance bounds, seen from outside the solver.
  double change_of_one_more_sweep(double h);

 protected:
  /// What one of the threads works with.
  struct Worker {
    PlanarProducts planar;
    long solves = 0;
  };

  /// With so many unknowns of each kind.
  FastForm(const EulerZeitlin& flow, const FastOptions& options,
           std::initializer_list<Index> unknowns);

  SolveReport advance(const Matrix& W0, double h, Matrix& W1) final;

  /// Sets the unknowns for a cold start.
  virtual void start_cold() = 0;
  /// Computes what follows from the unknowns where it is not the last sweep that set them.
  virtual void begin() {}
  /// As of solve_fixed_point.
  virtual double sweep(double h) = 0;
  /// W₁ from the last sweep.
  virtual void update(double h, PlanarMatrix& W1) = 0;

  /// B = B(W), counted; of W the upper triangle is read.
  void generator(const PlanarMatrix& W, PlanarMatrix& B, Worker& worker) const;

  /// Calls each phase(item, share, worker) for all items below `count`: by one thread, all phases
  /// of an item in turn, with the whole as its share; by two, phase by phase, with a half.  What
  /// cannot be halved is done with the first share.
  template <class... Phases>
  void in_phases(std::size_t count, Phases&&... phases) {
    if (team_.threads() == 1) {
      for (std::size_t item = 0; item < count; ++item) (phases(item, Share{}, workers_[0]), ...);
      return;
    }
    const auto by_two = [&](auto&& phase) {
      team_.run(2 * count, [&](std::size_t index, std::size_t thread) {
        phase(index / 2, Share{static_cast<Index>(index % 2), 2}, workers_[thread]);
      });
    };
    (by_two(phases), ...);
  }

  /// Calls half(0) and half(1), one for each half of something.
  template <class Half>
  void in_halves(Half&& half) {
    team_.run(2, [&](std::size_t index, std::size_t) { half(index); });
  }

  /// As update_unknowns of stage_sums.h, shared out; squares has twice as many entries, those of
  /// the one half of the numbers and then those of the other.
  void update_in_halves(const PlanarMatrix& base, double h, const RealMatrix& a,
                        const std::vector<PlanarMatrix>& Y, std::vector<PlanarMatrix>& X,
                        RealVector& squares);

  /// Of some places to work in, one for each item that is under way at a time, that of this one.
  std::size_t place(std::size_t item) const { return team_.threads() == 1 ? 0 : item; }
  Index places(Index count) const { return team_.threads() == 1 ? 1 : count; }

  PlanarMatrix zero() const { return PlanarMatrix(W0_.size()); }
  PlanarMatrix identity() const;
  std::vector<PlanarMatrix> zeros(Index count) const {
    return std::vector<PlanarMatrix>(static_cast<std::size_t>(count), zero());
  }

  PlanarMatrix W0_;
  Unknowns unknowns_;

 private:
  SolveReport iterate(double h, bool accelerated);
  SolveReport solve(double h);

  long products() const;
  double equivalent_products() const;
  long poisson_solves() const;

  FastOptions options_;
  Team team_;
  std::vector<Worker> workers_;
  PlanarLaplacian laplacian_;
  double reciprocal_hbar_;
  PlanarMatrix W1_;
  StartValues start_values_;
  Anderson anderson_;
  bool accelerates_;
};

}  // namespace isosyrk

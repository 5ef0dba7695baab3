// Inexact Newton and Picard iterations on small systems of which the solution is known.
#include "isosyrk/solver/newton.h"

#include <limits>
#include <vector>

#include "isosyrk/solver/alternating_correction.h"
#include "isosyrk/solver/neumann_correction.h"
#include "isosyrk/solver/picard_iteration.h"
#include "isosyrk/solver/tuning.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr Index n = 3;
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// Of norm 1, normal: products with it turn a matrix.
Matrix rotation(unsigned seed) { return exponential(random_skew_hermitian(n, seed)); }

// x = G(x) = c + T x + x K + ε x², solved by x = X of norm 1.
class Known final : public FixedPointSystem, public TwoPartJacobian {
 public:
  struct Sizes {
    double T = 0.5;
    double K = 0.1;
    double square = 0.0;
  };

  explicit Known(const Sizes& sizes)
      : T(sizes.T * rotation(1)), K(sizes.K * rotation(2)), square(sizes.square) {
    c = solution - G(solution);
  }

  ResidualSize residual(Corrections& R, Unknowns& x, double) override {
    ++residuals;
    at = x[0][0].interleaved();
    Matrix change = G(at) - at;
    if (loses_residual == residuals) change(1, 1) = not_a_number;
    R[0][0].load(change);
    return {.change = change.norm(), .neglected = 0.0};
  }
  Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) override {
    return correction.solve(delta, *this, x, R, request, options);
  }
  void far_sweep(Corrections& delta, const Unknowns& x, const Corrections& R,
                 const IterationOptions& options) override {
    AlternatingCorrection::sweep_frozen(delta, *this, x, R, options);
  }
  void linearise(const Unknowns&, double accuracy) override {
    ++linearisations;
    accuracy_asked = accuracy;
  }
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override {
    ++frozen_sweeps;
    const Matrix before = delta[0][0].interleaved();
    const Matrix right = rhs[0][0].interleaved();
    Matrix after = before;
    for (int k = 0; k < sweeps_a_call; ++k) after = right + sign_of_T * product({T, after});
    if (loses_sweeps) after(0, 0) = not_a_number;
    delta[0][0].load(after);
    return (after - before).norm();
  }
  bool solves_frozen() const override { return sweeps_a_call > 1; }
  void couple(Corrections& coupled, const Corrections& delta) override {
    ++couplings;
    Matrix result = sign_of_K * K_of(delta[0][0].interleaved());
    if (loses_couplings) result(0, 0) = not_a_number;
    coupled[0][0].load(result);
  }

  // What δ misses as a solution of δ = R + T δ + K δ.
  double miss_of(const Matrix& delta, const Matrix& R) const {
    return (delta - R - product({T, delta}) - K_of(delta)).norm();
  }

  Matrix T, K;
  double square;
  Matrix solution = random_matrix(n, 3).normalized();
  Matrix c = Matrix::Zero(n, n);
  Matrix at = Matrix::Zero(n, n);           // of the last residual
  double sign_of_T = 1.0, sign_of_K = 1.0;  // in what the solver is told
  int sweeps_a_call = 1;                    // of frozen sweeps: 80 are a solution
  int loses_residual = 0;                   // the call in which a number is lost
  bool loses_sweeps = false, loses_couplings = false;
  int residuals = 0, linearisations = 0, frozen_sweeps = 0, couplings = 0;
  double accuracy_asked = 0.0;
  double error = 0.0;  // of what was found
  AlternatingCorrection correction{{{SplitMatrix(n)}}};

 private:
  Matrix G(const Matrix& x) const {
    return c + product({T, x}) + product({x, K}) + square * product({x, x});
  }
  Matrix K_of(const Matrix& delta) const {
    return product({delta, K}) + square * (product({at, delta}) + product({delta, at}));
  }
};

const Matrix nothing = Matrix::Zero(n, n);

Unknowns start_at(const Matrix& x) { return {{SplitMatrix(x)}}; }

SolveReport newton(Known& system, const Matrix& start = nothing, double tolerance = 1e-13) {
  Unknowns x = start_at(start);
  IterationMemory nothing_seen;
  const SolveReport report = Newton(x).solve(system, nothing_seen, {.tolerance = tolerance}, x);
  system.error = (x[0][0].interleaved() - system.solution).norm();
  return report;
}

SolveReport picard(Known& system, const Matrix& start = nothing, bool with_frozen_sweeps = false) {
  Unknowns x = start_at(start);
  PicardIteration iteration(x);
  const SolveReport report = with_frozen_sweeps ? iteration.solve_by_far_sweeps(system, {}, x)
                                                : iteration.solve(system, {}, x);
  system.error = (x[0][0].interleaved() - system.solution).norm();
  return report;
}

Matrix beside_the_solution(const Known& system, double distance = 0.01) {
  return system.solution + distance * rotation(5);
}

// A change below the tolerance leaves tolerance / (1 - contraction) of error, the contraction being
// |T| + |K| + 2 ε |x|.
TEST(Newton, FindsTheKnownSolutionInFewerSweepsThanPicard) {
  for (const Known::Sizes& sizes :
       {Known::Sizes{0.5, 0.1}, Known::Sizes{0.8, 0.05}, Known::Sizes{0.1, 0.3},
        Known::Sizes{0.4, 0.05, 0.1}, Known::Sizes{0.0, 0.0, 0.2}}) {
    const double contraction = sizes.T + sizes.K + 2.0 * sizes.square;
    const double bound = 1e-13 / (1.0 - contraction);
    Known corrected(sizes), plain(sizes);
    const SolveReport found = newton(corrected), expected = picard(plain);
    EXPECT_EQ(found.status, Status::converged);
    EXPECT_EQ(expected.status, Status::converged);
    EXPECT_LE(corrected.error, bound);
    EXPECT_LE(plain.error, bound);
    EXPECT_LT(found.sweeps, 0.6 * expected.sweeps) << sizes.T << " " << sizes.K;
    EXPECT_EQ(found.sweeps, corrected.residuals);
    EXPECT_GT(corrected.linearisations, 0);
    EXPECT_EQ(plain.linearisations + plain.frozen_sweeps + plain.couplings, 0);
  }
}

TEST(PicardIteration, ConvergesSoonerWithAFrozenSweep) {
  Known once({0.7, 0.01}), plain({0.7, 0.01});
  const SolveReport with_sweep = picard(once, nothing, true);
  EXPECT_EQ(with_sweep.status, Status::converged);
  EXPECT_LE(once.error, 1e-13 / (1.0 - 0.71));
  EXPECT_LT(with_sweep.sweeps, 0.65 * picard(plain).sweeps);
  EXPECT_EQ(once.frozen_sweeps, with_sweep.sweeps - 1) << "none for what is accepted";
  EXPECT_EQ(once.couplings, 0);
}

TEST(Newton, AWrongSignOfAPartOfTheJacobianCostsSweeps) {
  Known right({0.3, 0.2}), wrong_T({0.3, 0.2}), wrong_K({0.3, 0.2});
  wrong_T.sign_of_T = wrong_K.sign_of_K = -1.0;
  const int sweeps = newton(right).sweeps;
  EXPECT_GT(newton(wrong_T).sweeps, sweeps + 3);
  EXPECT_GT(newton(wrong_K).sweeps, sweeps + 3);
}

double forcing_term_of(double size, double tolerance) {
  return std::max({tuning.forcing_of_tolerance * tolerance, tuning.forcing_relative * size,
                   tuning.forcing_quadratic * size * size});
}

// δ - R - T δ - K δ is left at the forcing term: single precision's 1e-6 of R, 0.3 of the
// tolerance, or 0.1 |R|².  The estimate that ends it, of the error of δ, may be out by a small
// factor: 3 here, and 1 + 0.6 from the error to what is left.
TEST(AlternatingCorrection, SolvesToTheForcingTerm) {
  const auto miss_of = [](double size, double tolerance, Known& system) {
    const Unknowns x = start_at(system.solution);
    const Corrections right = {{SingleMatrix(Matrix(size * random_matrix(n, 9).normalized()))}};
    Corrections delta = corrections_like(x);
    const double forcing_term = forcing_term_of(size, tolerance);
    const Correction found = system.correct(
        delta, x, right, {.size = size, .forcing_term = forcing_term}, {.tolerance = tolerance});
    EXPECT_TRUE(found.usable);
    EXPECT_LT(found.error, forcing_term);
    return system.miss_of(delta[0][0].interleaved(), right[0][0].interleaved());
  };
  int last = 0;
  for (const double size : {0.3, 1e-2, 1e-4, 1e-7}) {
    constexpr double tolerance = 1e-13;
    Known system({0.5, 0.1});
    const double forcing_term = forcing_term_of(size, tolerance);
    EXPECT_LE(miss_of(size, tolerance, system), 3.0 * forcing_term * 1.6) << size;
    EXPECT_EQ(system.linearisations, 1);
    EXPECT_DOUBLE_EQ(system.accuracy_asked, tuning.jacobian_share * forcing_term / size);
    EXPECT_GE(system.frozen_sweeps + system.couplings, last) << size;
    last = system.frozen_sweeps + system.couplings;
  }
  // It stops there: more digits than the forcing term asks for are not paid for.
  Known rough({0.5, 0.1}), loose({0.5, 0.1}), fine({0.5, 0.1});
  EXPECT_GT(miss_of(0.3, 1e-13, rough), 1e-5 * 0.3);
  EXPECT_GT(miss_of(1e-4, 1e-5, loose), 1e-5 * 1e-4);
  miss_of(1e-4, 1e-13, fine);
  EXPECT_LT(rough.frozen_sweeps, fine.frozen_sweeps);
  EXPECT_LT(loose.frozen_sweeps, fine.frozen_sweeps);
}

TEST(Newton, SolvesWhereFrozenSweepsAreSolutions) {
  Known solved({0.6, 0.1}), swept({0.6, 0.1});
  solved.sweeps_a_call = 80;
  EXPECT_EQ(newton(solved).status, Status::converged);
  EXPECT_LE(solved.error, 1e-13 / 0.3);
  newton(swept);
  EXPECT_LT(solved.frozen_sweeps, swept.frozen_sweeps);
}

// One Picard sweep contracts by 0.1 unless it was seen to do otherwise.
TEST(Newton, ComputesNoCorrectionWhereThreePicardSweepsWillDoAtSmallN) {
  constexpr double tolerance = 1e-6;
  // Started so many tolerances from the solution; returns sweeps and linearisations.
  const auto work = [](const Known::Sizes& sizes, double distance) {
    Known system(sizes);
    const Matrix start = beside_the_solution(system, distance * tolerance / std::sqrt(3.0));
    const SolveReport report = newton(system, start, tolerance);
    EXPECT_EQ(report.status, Status::converged);
    return std::pair(report.sweeps, system.linearisations);
  };
  const Known::Sizes fast = {0.05, 0.03}, slow = {-0.85, 0.03};
  EXPECT_EQ(work(fast, 0.1), std::pair(1, 0));
  EXPECT_EQ(work(fast, 4.0), std::pair(2, 0));
  EXPECT_EQ(work(fast, 40.0).second, 0);
  EXPECT_EQ(work(fast, 4000.0).second, 1);
  EXPECT_EQ(work(slow, 2.0).second, 1) << "the first sweep tells";
}

TEST(Newton, RemembersTheContractionUntilItForgets) {
  constexpr double tolerance = 1e-6;
  Known system({-0.85, 0.03});
  const Unknowns near = start_at(beside_the_solution(system, 2.0 * tolerance / std::sqrt(3.0)));
  Newton solver(near);
  IterationMemory memory;
  const auto sweeps = [&] {
    Unknowns x = near;
    return solver.solve(system, memory, {.tolerance = tolerance}, x).sweeps;
  };
  const int first = sweeps();
  EXPECT_LT(sweeps(), first) << "no sweep is lost to find out";
  memory.forget();
  EXPECT_EQ(sweeps(), first);
}

// Whichever part it is that grows, and whether by much or little.  The second change, near the
// solution, is that of a Picard sweep; far from it sweeps with B frozen follow, which grow too.
TEST(Newton, TakesPicardSweepsWherePartsDoNotContract) {
  for (const Known::Sizes& sizes :
       {Known::Sizes{40.0, 0.1}, Known::Sizes{5.0, 0.1}, Known::Sizes{1.5, 0.1},
        Known::Sizes{0.1, 1.5}, Known::Sizes{0.1, 5.0}}) {
    SCOPED_TRACE(::testing::Message() << sizes.T << " " << sizes.K);
    Known system(sizes), plain(sizes);
    const SolveReport report = newton(system, beside_the_solution(system, 1e-3));
    const SolveReport expected = picard(plain, beside_the_solution(plain, 1e-3));
    EXPECT_EQ(report.status, Status::diverged);
    EXPECT_GT(system.linearisations, 0);
    EXPECT_EQ(expected.status, Status::diverged);
    EXPECT_LE(report.sweeps, expected.sweeps);
    Known near(sizes), plain_near(sizes);
    Unknowns x = start_at(beside_the_solution(near, 1e-3)), y = x;
    const IterationOptions two_sweeps = {.tolerance = 1e-13, .max_sweeps = 2};
    IterationMemory nothing_seen;
    const double change = Newton(x).solve(near, nothing_seen, two_sweeps, x).change;
    const double of_picard = PicardIteration(y).solve(plain_near, two_sweeps, y).change;
    EXPECT_NEAR(change, of_picard, 1e-3 * of_picard);
  }
}

// G(x) = c + U x with a rotation U: changes keep their size, and no correction can be had.
TEST(Newton, EndsStagnatedWhereNeitherContracts) {
  Known turning({1.0, 0.0});
  turning.loses_sweeps = true;
  const SolveReport report = newton(turning, beside_the_solution(turning));
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_LE(report.sweeps, 150);
  EXPECT_GT(turning.linearisations, 0);
}

TEST(Newton, ANumberLostInACorrectionCostsTheCorrectionOnly) {
  for (const bool in_couplings : {false, true}) {
    Known system({0.5, 0.1});
    (in_couplings ? system.loses_couplings : system.loses_sweeps) = true;
    const SolveReport report = newton(system);
    EXPECT_EQ(report.status, Status::converged) << in_couplings;
    EXPECT_LE(system.error, 1e-13 / 0.4);
    EXPECT_GT(system.linearisations, 0);
    Known plain({0.5, 0.1});
    EXPECT_NEAR(report.sweeps, picard(plain).sweeps, 2);
  }
}

// x moves by a Picard sweep where the correction is lost, and that sweep shows the contraction.
TEST(Newton, ASweepAfterALostCorrectionShowsTheContraction) {
  Known system({1e-3, 0.0});
  system.loses_sweeps = true;
  // Changes of 1e-2, 1e-5, 1e-8 ...: three sweeps end the iteration from 1e-5 on, as is then known.
  const SolveReport report = newton(system, beside_the_solution(system));
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(system.linearisations, 1);
}

// The control: a sweep after a correction that was used shows what the correction left instead.
TEST(Newton, TheContractionIsThatOfPicardSweepsAlone) {
  const auto seen = [](bool loses_corrections) {
    Known system({1e-3, 0.0});
    system.loses_sweeps = loses_corrections;
    Unknowns x = start_at(beside_the_solution(system));
    IterationMemory memory;
    Newton(x).solve(system, memory, {.tolerance = 1e-13, .max_sweeps = 2}, x);
    EXPECT_EQ(memory.left_by_correction.has_value(), !loses_corrections);
    return memory.contraction;
  };
  EXPECT_NEAR(seen(true), 1e-3, 1e-6);
  EXPECT_EQ(seen(false), tuning.likely_contraction);
}

TEST(Newton, ANumberLostInAResidualDiverges) {
  for (const int at : {1, 2, 3}) {
    Known system({0.5, 0.1});
    system.loses_residual = at;
    const SolveReport report = newton(system, beside_the_solution(system));
    EXPECT_EQ(report.status, Status::diverged) << at;
    EXPECT_EQ(report.sweeps, at);
    EXPECT_EQ(system.linearisations, at - 1) << "none of what is not a number";
  }
}

// x = G(x) = c + K(x - X) + ε (x - X)² around the solution X: four numbers on the diagonal of a 2 x
// 2 matrix of each of two unknowns.  Nothing of it is frozen.  It starts from an explicit guess,
// and its G has an error of half the accuracy that it is asked for.
class Smoothing final : public FixedPointSystem, public Coupling {
 public:
  static constexpr Index size = 2;

  explicit Smoothing(double K, Acceptance::By by) : K_(K) { rule_.by = by; }

  Unknowns started(double distance) const {
    Unknowns x = solution_;
    for (SplitMatrix& each : x[0]) {
      each.load(each.interleaved() + distance * Matrix::Identity(size, size));
    }
    return x;
  }
  double error_of(const Unknowns& x) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      largest = std::max(largest, (x[0][i].interleaved() - X(i)).norm());
    }
    return largest;
  }

  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override {
    accuracies.push_back(accuracy);
    double largest = 0.0;
    const Matrix neglected = (neglects * accuracy / std::sqrt(2.0)) * Matrix::Identity(size, size);
    for (std::size_t i = 0; i < 2; ++i) {
      const Matrix d = x[0][i].interleaved() - X(i);
      const Matrix change = K_ * d + square_ * product({d, d}) - d + neglected;
      largest = std::max(largest, change.norm());
      R[0][i].load(change);
    }
    return {.change = largest, .neglected = neglects * accuracy};
  }
  Correction correct(Corrections& delta, const Unknowns&, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) override {
    return correction_.solve(delta, *this, R, request, options);
  }
  void couple(Corrections& coupled, const Corrections& delta, double) override {
    ++couplings;
    for (std::size_t i = 0; i < 2; ++i) {
      coupled[0][i].load(sign_of_K_told * K_ * delta[0][i].interleaved());
    }
  }
  ConvergenceTest convergence_test(const Unknowns& x, double tolerance,
                                   IterationMemory& memory) const override {
    return {rule_, tolerance, x[0][0].size(), 0.0, memory};
  }

  double neglects = 0.5;        // of the accuracy asked
  double sign_of_K_told = 1.0;  // -1: a wrong Jacobian
  std::vector<double> accuracies;
  int couplings = 0;

 private:
  Matrix X(std::size_t i) const { return solution_[0][i].interleaved(); }

  double K_;
  double square_ = 0.1;
  Acceptance rule_;
  Unknowns solution_ = {{SplitMatrix(Matrix(Matrix::Identity(size, size))),
                         SplitMatrix(Matrix(-0.5 * Matrix::Identity(size, size)))}};
  NeumannCorrection correction_{solution_};
};

constexpr double tolerance = 1e-12;

// Any residual may be accepted: each may err by a tenth of the tolerance, or by a fifth
// (accepting_accuracy), and no more.
TEST(NewtonWithNeumannCorrection, AsksOfEachResidualTheAccuracyThatAcceptanceNeeds) {
  for (const auto by : {Acceptance::By::change, Acceptance::By::error_estimate}) {
    Smoothing system(0.1, by);
    Newton solver(system.started(0.0));
    IterationMemory memory;
    for (const double distance : {1e-1, 1e-3, 1e-3}) {
      Unknowns x = system.started(distance);
      const SolveReport report = solver.solve(system, memory, {.tolerance = tolerance}, x);
      EXPECT_EQ(report.status, Status::converged);
      // What is accepted errs by the neglected, by what the correction leaves and, by the change of
      // a sweep, by its contraction.
      EXPECT_LE(system.error_of(x), 1.5 * tolerance);
    }
    const double accepting = Acceptance{.by = by}.accepting_accuracy(tolerance);
    for (const double accuracy : system.accuracies) EXPECT_EQ(accuracy, accepting);
    EXPECT_GT(system.couplings, 0);
  }
}

TEST(NewtonWithNeumannCorrection, IsAcceptedByEstimateInFewerSweepsButNotFarFromTheSolution) {
  const auto sweeps = [](Acceptance::By by, double distance) {
    Smoothing system(0.1, by);
    Newton solver(system.started(0.0));
    IterationMemory memory;
    Unknowns x = system.started(distance);
    const SolveReport report = solver.solve(system, memory, {.tolerance = tolerance}, x);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_LE(system.error_of(x), 1.5 * tolerance);
    return report.sweeps;
  };
  // At 1e-6 one correction leaves 0.1 · 1e-12 by its square and 1e-12 by single precision.
  EXPECT_EQ(sweeps(Acceptance::By::error_estimate, 1e-7), 1);
  EXPECT_EQ(sweeps(Acceptance::By::change, 1e-7), 2);
  EXPECT_GE(sweeps(Acceptance::By::error_estimate, 0.1), 3) << "beyond the guard";
}

// At this n three Picard sweeps cost less than a correction and the sweep that accepts it, but not
// less than a correction that is accepted by itself.
TEST(NewtonWithNeumannCorrection, TakesThreeSweepsForACorrectionOnlyWhereThatSavesASweep) {
  for (const auto by : {Acceptance::By::change, Acceptance::By::error_estimate}) {
    Smoothing system(0.1, by);
    Newton solver(system.started(0.0));
    IterationMemory memory;
    Unknowns x = system.started(1e-10);
    const SolveReport report = solver.solve(system, memory, {.tolerance = tolerance}, x);
    const bool by_estimate = by == Acceptance::By::error_estimate;
    EXPECT_EQ(report.sweeps == 1, by_estimate);
    EXPECT_EQ(system.couplings > 0, by_estimate);
    EXPECT_LE(system.error_of(x), 1.5 * tolerance);
  }
}

TEST(NewtonWithNeumannCorrection, ATermThatGrowsIsNoCorrection) {
  Smoothing system(0.1, Acceptance::By::change);
  system.sign_of_K_told = 12.0;  // K told is 1.2
  Newton solver(system.started(0.0));
  IterationMemory memory;
  Unknowns x = system.started(1e-3);
  EXPECT_EQ(solver.solve(system, memory, {.tolerance = tolerance}, x).status, Status::converged);
  EXPECT_GT(system.couplings, 0);
  EXPECT_LE(system.error_of(x), 1.5 * tolerance) << "by Picard sweeps";
}

}  // namespace
}  // namespace isosyrk::testing

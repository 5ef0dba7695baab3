#include "core/fast_form.h"

#include "core/euler_zeitlin.h"
#include "core/stage_sums.h"

namespace isosyrk {

namespace {

// Below these it costs more than it saves (measured).
constexpr Index smallest_accelerated = 32;
constexpr Index smallest_shared = 48;

Unknowns zero_unknowns(Index n, std::initializer_list<Index> counts) {
  Unknowns unknowns;
  for (const Index count : counts) {
    unknowns.emplace_back(static_cast<std::size_t>(count), PlanarMatrix(n));
  }
  return unknowns;
}

}  // namespace

int default_start_order(Index n) { return n < 96 ? 10 : 9; }

FastForm::FastForm(const EulerZeitlin& flow, const FastOptions& options,
                   std::initializer_list<Index> unknowns)
    : Integrator(flow, ProductBackend::openblas),
      W0_(flow.size()),
      unknowns_(zero_unknowns(flow.size(), unknowns)),
      options_(options),
      team_(options.threads == 2 && flow.size() < smallest_shared ? 1 : options.threads),
      workers_(static_cast<std::size_t>(team_.threads()), Worker{PlanarProducts(flow.size())}),
      laplacian_(flow.laplacian()),
      reciprocal_hbar_(1.0 / hbar(flow.convention(), flow.size())),
      W1_(flow.size()),
      start_values_(options.start_order.value_or(default_start_order(flow.size())), unknowns_),
      anderson_(unknowns_),
      accelerates_(options.accelerate.value_or(unknowns_[0].size() == 1 &&
                                               flow.size() >= smallest_accelerated)) {}

PlanarMatrix FastForm::identity() const {
  PlanarMatrix I = zero();
  for (Index i = 0; i < I.size(); ++i) I.re()[i * I.stride() + i] = 1.0;
  return I;
}

void FastForm::generator(const PlanarMatrix& W, PlanarMatrix& B, Worker& worker) const {
  laplacian_.solve_skew_hermitian(W, reciprocal_hbar_, B);
  ++worker.solves;
}

void FastForm::update_in_halves(const PlanarMatrix& base, double h, const RealMatrix& a,
                                const std::vector<PlanarMatrix>& Y, std::vector<PlanarMatrix>& X,
                                RealVector& squares) {
  in_halves([&](std::size_t half) {
    const Half numbers(reals(base).size(), half);
    double* half_of_squares = squares.data() + (half == 0 ? 0 : static_cast<Index>(X.size()));
    update_unknowns(base, h, a, Y, X, half_of_squares, numbers.begin, numbers.end);
  });
}

long FastForm::products() const {
  long sum = 0;
  for (const Worker& each : workers_) sum += each.planar.count();
  return sum;
}

double FastForm::equivalent_products() const {
  double sum = 0.0;
  for (const Worker& each : workers_) sum += each.planar.equivalents();
  return sum;
}

long FastForm::poisson_solves() const {
  long sum = 0;
  for (const Worker& each : workers_) sum += each.solves;
  return sum;
}

SolveReport FastForm::iterate(double h, bool accelerated) {
  begin();
  if (!accelerated) return solve_fixed_point(options_.solver, [&] { return sweep(h); });
  anderson_.begin(unknowns_);
  return solve_fixed_point(options_.solver, [&] {
    const double change = sweep(h);
    if (change >= options_.solver.tolerance) {  // else what the sweep gave is accepted
      anderson_.mix(unknowns_);
      begin();
    }
    return change;
  });
}

SolveReport FastForm::solve(double h) {
  SolveReport report;
  int wasted = 0;
  const auto converges = [&](bool accelerated) {
    wasted += report.sweeps;
    report = iterate(h, accelerated);
    return report.status == Status::converged;
  };
  if (start_values_.predict(h, unknowns_, team_)) {
    if (converges(accelerates_)) return report;
    start_values_.forget();
  }
  start_cold();
  if (!converges(accelerates_)) {
    start_cold();
    converges(!accelerates_);
  }
  report.sweeps += wasted;
  return report;
}

double FastForm::change_of_one_more_sweep(double h) {
  const Unknowns accepted = unknowns_;
  begin();
  const double change = sweep(h);
  unknowns_ = accepted;
  return change;
}

SolveReport FastForm::advance(const Matrix& W0, double h, Matrix& W1) {
  const long products_before = products();
  const double equivalents_before = equivalent_products();
  const long solves_before = poisson_solves();
  W0_.load(W0);
  // Another state than this form ended at: what it knows is of another trajectory.
  if (W0_.entries() != W1_.entries()) start_values_.forget();
  const SolveReport report = solve(h);
  if (report.status == Status::converged) {
    update(h, W1_);
    start_values_.accept(h, unknowns_);
    W1_.store(W1);
  } else {
    start_values_.forget();
  }
  add_work({.products = products() - products_before,
            .poisson_solves = poisson_solves() - solves_before,
            .equivalent_products = equivalent_products() - equivalents_before});
  return report;
}

}  // namespace isosyrk

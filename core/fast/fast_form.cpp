#include "isosyrk/fast/fast_form.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/iteration/picard.h"
#include "isosyrk/split/flush_denormals.h"
#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"

namespace isosyrk {

namespace {

// Below these it costs more than it saves (measured).
constexpr Index smallest_cut = 48;
constexpr Index smallest_shared = 48;
constexpr Index smallest_halved = 96;  // where all is in halves, as with one stage

// Beyond this the derivative says too little of a sweep (measured).
constexpr double largest_corrected = 0.3;

// Of a plain sweep close to the solution, and of K: a first guess.
constexpr double likely_contraction = 0.1;

Unknowns zero_unknowns(Index n, std::initializer_list<Items> kinds) {
  Unknowns unknowns;
  for (const Items& kind : kinds) unknowns.emplace_back(kind.count, PlanarMatrix(n));
  return unknowns;
}

// All items of all kinds, so that each is where it is among those of its own.
std::vector<std::pair<std::size_t, std::size_t>> order_of(std::initializer_list<Items> kinds) {
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (const std::size_t part : {0, 1, 2}) {  // the first thread's, the second one's, the halved
    std::size_t number = 0;
    for (const Items& kind : kinds) {
      const std::array<std::size_t, 4> bounds{0, kind.whole() / 2, kind.whole(), kind.count};
      for (std::size_t item = bounds[part]; item < bounds[part + 1]; ++item) {
        order.emplace_back(number, item);
      }
      ++number;
    }
  }
  return order;
}

// How many threads pay.
int threads_for(int asked, const Items& unknowns, Index n) {
  const Index smallest = unknowns.whole() > 0 ? smallest_shared : smallest_halved;
  return asked == 2 && n < smallest ? 1 : asked;
}

Items all_of(std::initializer_list<Items> kinds) {
  Items all(0);
  for (const Items& kind : kinds) {
    all.count += kind.count;
    all.halved += kind.halved;
  }
  return all;
}

}  // namespace

int default_start_order(Index n) {
  if (n < 48) return 16;
  return n < 192 ? 24 : 12;
}

FastForm::FastForm(const EulerZeitlin& flow, const FastOptions& options,
                   std::initializer_list<Items> unknowns, Index least_coupling_band)
    : Integrator(flow),
      W0_(flow.size()),
      unknowns_(zero_unknowns(flow.size(), unknowns)),
      options_(options),
      order_(order_of(unknowns)),
      all_items_(all_of(unknowns)),
      team_(threads_for(options.threads, all_items_, flow.size())),
      workers_(static_cast<std::size_t>(team_.threads()),
               Worker{PlanarProducts(flow.size()), SingleProducts(flow.size())}),
      laplacian_(flow.laplacian()),
      single_laplacian_(flow.laplacian()),
      reciprocal_hbar_(1.0 / hbar(flow.convention(), flow.size())),
      W1_(flow.size()),
      start_values_(options.start_order.value_or(default_start_order(flow.size())),
                    options.fit_start, unknowns_),
      anderson_(unknowns_),
      cuts_(options.bands.value_or(flow.size() >= smallest_cut)),
      least_coupling_band_(least_coupling_band) {
  for (const Items& kind : unknowns) residuals_.push_back(singles(kind.count));
  delta_ = rhs_ = next_rhs_ = residuals_;
  const std::size_t all = all_items_.count;
  squares_[0] = squares_[1] = RealVector::Zero(static_cast<Index>(all));
  const RealVector of_diagonals = RealVector::Zero(flow.size());
  generator_squares_.assign(all, of_diagonals);
  row_squares_.assign(all, {of_diagonals, of_diagonals});
}

PlanarMatrix FastForm::identity() const {
  PlanarMatrix I = zero();
  for (Index i = 0; i < I.size(); ++i) I.re()[i * I.stride() + i] = 1.0;
  return I;
}

double FastForm::left_out() const { return 0.01 * options_.solver.tolerance; }

void FastForm::solve_generator(std::size_t item, const PlanarMatrix& W, PlanarMatrix& B,
                               Share share, Worker& worker) {
  const Index whole = W.size() - 1;
  laplacian_.solve_upper(W, reciprocal_hbar_, B, whole, share);
  if (share.is_first()) ++worker.solves;
  if (!cuts_) return;
  const Diagonals solved(W.size(), whole, share);
  diagonal_squares_of_skew(B, solved.begin, solved.end, generator_squares_[item]);
}

void FastForm::finish_generator(std::size_t item, PlanarMatrix& B, Share share) const {
  const Index band =
      cuts_ ? smallest_band(generator_squares_[item], left_out() / step_) : B.size() - 1;
  mirror_skew_within(band, B, share);
}

void FastForm::solve_generator(const SingleMatrix& W, SingleMatrix& B, Share share,
                               Worker& worker) const {
  single_laplacian_.solve_upper(W, static_cast<float>(reciprocal_hbar_), B, coupling_band_, share);
  if (share.is_first()) ++worker.solves;
}

void FastForm::finish_generator(SingleMatrix& B, Share share) const {
  mirror_skew_within(coupling_band_, B, share);
}

Index FastForm::widest_band(const Singles& matrices) {
  Index widest = 0;
  for (const SingleMatrix& each : matrices) widest = std::max(widest, each.band());
  return widest;
}

void FastForm::narrow_generator(std::size_t item, const PlanarMatrix& B, double h, double accuracy,
                                SingleMatrix& S, Share share) const {
  narrow(B, S, share);
  if (!cuts_) return;
  cut_to_band(smallest_band(generator_squares_[item], accuracy / std::abs(h)), S, share);
}

double FastForm::residuals_of_stages(const PlanarMatrix& base, double h, const RealMatrix& a,
                                     const std::vector<PlanarMatrix>& Y,
                                     const std::vector<PlanarMatrix>& X,
                                     std::vector<SingleMatrix>& R) {
  if (each_has_its_own(X.size())) {
    in_halves_of(X.size(), [&](std::size_t i, Share half) {
      half_of_squares(half)[i] =
          isosyrk::residual(base, h, a, static_cast<Index>(i), Y, X[i], R[i], half);
    });
  } else {
    in_halves([&](Share half) { residuals(base, h, a, Y, X, R, half_of_squares(half), half); });
  }
  return largest_of_squares(static_cast<Index>(X.size()));
}

double FastForm::largest_of_squares(Index count) const {
  double largest = 0.0;
  for (Index i = 0; i < count; ++i) largest = larger(largest, squares_[0](i) + squares_[1](i));
  return std::sqrt(largest);
}

long FastForm::products() const {
  long sum = 0;
  for (const Worker& each : workers_) sum += each.planar.count() + each.singles.count();
  return sum;
}

double FastForm::equivalent_products() const {
  std::int64_t in_double = 0;
  std::int64_t in_single = 0;
  for (const Worker& each : workers_) {
    in_double += each.planar.half_multiplications();
    in_single += each.singles.half_multiplications();
  }
  return (static_cast<double>(in_double) + 0.5 * static_cast<double>(in_single)) /
         (2.0 * workers_[0].planar.cube());
}

long FastForm::poisson_solves() const {
  long sum = 0;
  for (const Worker& each : workers_) sum += each.solves;
  return sum;
}

SolveReport FastForm::iterate(double h, Iteration iteration) {
  begin();
  switch (iteration) {
    case Iteration::plain:
      break;
    case Iteration::accelerated:
      anderson_.begin(unknowns_);
      return solve_fixed_point(options_.solver, [&] {
        const double change = sweep(h);
        if (change >= options_.solver.tolerance) {  // else what the sweep gave is accepted
          anderson_.mix(unknowns_);
          begin();
        }
        return change;
      });
    case Iteration::corrected:
      return solve_fixed_point(options_.solver, [&, left_plain = 0.0]() mutable {
        const double tolerance = options_.solver.tolerance;
        const double change = residual(h);
        if (left_plain > 0.0) contraction_ = change / left_plain;
        const bool plain_will_do = std::min(1.0, 2.0 * contraction_) * change < tolerance;
        const bool corrected = !plain_will_do && change <= largest_corrected && correct(h, change);
        left_plain = plain_will_do ? change : 0.0;
        add_correction(corrected ? delta_ : residuals_);
        begin();
        return change;
      });
  }
  return solve_fixed_point(options_.solver, [&] { return sweep(h); });
}

void FastForm::add_correction(const SingleUnknowns& correction) {
  in_halves_of_unknowns([&](std::size_t kind, std::size_t i, Share half) {
    add(correction[kind][i], unknowns_[kind][i], half);
  });
}

void FastForm::shift(std::size_t kind, std::size_t item, SingleMatrix& moved, Share share) {
  for_halves(share, [&](Share half) {
    planar_sums::Assigned<float> squares = planar_sums::Assigned<float>::Zero();
    assign(moved, half, [&](const auto& load) {
      const auto change = (load(next_rhs_[kind][item]) - load(rhs_[kind][item])).eval();
      squares += change.square();
      return (load(delta_[kind][item]) + change).eval();
    });
    half_of_squares(half)[item] = static_cast<double>(squares.sum());
  });
}

void FastForm::couple_with(std::size_t kind, std::size_t item, const SingleMatrix& product,
                           SingleMatrix& moved, Share share) {
  reals(next_rhs_[kind][item], share) =
      reals(residuals_[kind][item], share) + reals(product, share);
  shift(kind, item, moved, share);
}

// Unknowns are numbered through all kinds.
std::size_t FastForm::number(std::size_t kind, std::size_t item) const {
  std::size_t before = 0;
  for (std::size_t k = 0; k < kind; ++k) before += unknowns_[k].size();
  return before + item;
}

void FastForm::cut_unknowns(std::size_t kind) {
  in_phases(
      unknowns_[kind].size(),
      [&](std::size_t i, Share share, Worker&) { measure_unknown(kind, i, share); },
      [&](std::size_t i, Share share, Worker&) { cut_unknown(kind, i, share); });
}

double FastForm::update_and_cut(std::size_t kind, const PlanarMatrix& base, double h,
                                const RealMatrix& a, const std::vector<PlanarMatrix>& Y) {
  return update_stages(
      base, h, a, Y, unknowns_[kind],
      [&](std::size_t i, Share share, Worker&) { measure_unknown(kind, i, share); },
      [&](std::size_t i, Share share, Worker&) { cut_unknown(kind, i, share); });
}

bool FastForm::predict(double h) {
  if (!start_values_.begin(h)) return false;
  in_halves_of_unknowns([&](std::size_t kind, std::size_t i, Share half) {
    start_values_.predict(kind, i, unknowns_[kind][i], half);
  });
  return true;
}

// Finds δ by turns of T and K, each taken where the larger part of the error is its own, until what
// is left is some digits under the change or well under the tolerance: estimates from how the two
// have contracted so far.  Returns false where they do not.
bool FastForm::correct(double h, double change) {
  constexpr double digits = 1e-6;  // of single precision, after a few sums
  constexpr double of_tolerance = 0.3;
  constexpr double curvature = 0.1;  // the derivative errs by this, relative to a change of 1
  constexpr double growth = 4.0;     // what T may do at first, not being normal
  constexpr int most = 60;
  const double target = std::max(
      {of_tolerance * options_.solver.tolerance, digits * change, curvature * change * change});
  coupling_band_ = std::max(linearise(h, 0.3 * target / change), least_coupling_band_);
  double T_contraction = 0.0;
  double K_contraction = likely_contraction;
  double T_error = change;
  double not_coupled = change;  // what has come to δ since K was last applied
  double last = change;
  bool shifted = false;
  for (int k = 0; k < most; ++k) {
    const double K_error = K_contraction * not_coupled;
    if (T_error + K_error < target) break;
    if (k > 0 && K_error > T_error) {
      last = couple(h);
      std::swap(rhs_, next_rhs_);
      K_contraction = std::max(0.5 * K_contraction, last / not_coupled);
      not_coupled = last;
      T_error = solves_transport() ? last : T_error + last * T_contraction / (1.0 - T_contraction);
      shifted = true;
    } else {
      const double now = transport(h);
      const double before = shifted ? last + T_error : last;
      if (!(now < growth * before)) return false;  // NaN included
      T_contraction = std::max(shifted ? T_contraction : 0.9 * T_contraction, now / before);
      T_contraction = std::min(T_contraction, 0.9);
      last = now;
      T_error = solves_transport() ? 0.0 : now * T_contraction / (1.0 - T_contraction);
      not_coupled += now;
      shifted = false;
    }
  }
  return true;
}

Attempt attempt_of(Start start, int iteration) {
  constexpr std::array<isosyrk::Iteration, 3> names = {
      isosyrk::Iteration::picard, isosyrk::Iteration::anderson, isosyrk::Iteration::newton};
  return {start, names[static_cast<std::size_t>(iteration)]};
}

SolveReport FastForm::solve(double h, Attempt& attempt) {
  SolveReport report;
  int wasted = 0;
  const auto converges = [&](Start start, Iteration iteration) {
    wasted += report.sweeps;
    report = iterate(h, iteration);
    attempt = attempt_of(start, static_cast<int>(iteration));
    return report.status == Status::converged;
  };
  const Iteration uncorrected = options_.accelerate ? Iteration::accelerated : Iteration::plain;
  const Iteration other = options_.accelerate ? Iteration::plain : Iteration::accelerated;
  const std::array<Iteration, 3> attempts = {Iteration::corrected, uncorrected, other};
  const std::size_t first = corrects() ? 0 : 1;
  if (predict(h)) {
    if (converges(Start::predicted, attempts[first])) return report;
    start_values_.forget();
  }
  contraction_ = likely_contraction;
  for (std::size_t i = first; i < attempts.size(); ++i) {
    start_cold();
    if (converges(Start::cold, attempts[i])) break;
  }
  report.sweeps += wasted;
  return report;
}

double FastForm::change_of_one_more_sweep(double h) {
  const FlushDenormals flush;
  const Unknowns accepted = unknowns_;
  const bool cuts = std::exchange(cuts_, false);
  step_ = std::abs(h);
  begin_step();
  begin();
  const double change = sweep(h);
  unknowns_ = accepted;
  cuts_ = cuts;
  return change;
}

StepReport FastForm::advance(const Matrix& W0, double h, Matrix& W1) {
  const FlushDenormals flush;
  const long products_before = products();
  const double equivalents_before = equivalent_products();
  const long solves_before = poisson_solves();
  std::array<bool, 2> is_another{};
  in_halves([&](Share half) {
    W0_.load(W0, half);
    is_another[static_cast<std::size_t>(half.part)] = (reals(W0_, half) != reals(W1_, half)).any();
  });
  // Another state than this form ended at: what it knows is of another trajectory.
  if (is_another[0] || is_another[1]) start_values_.forget();
  step_ = std::abs(h);
  begin_step();
  Attempt attempt;
  const SolveReport report = solve(h, attempt);
  if (report.status == Status::converged) {
    update(h, W1_);
    start_values_.accept(h);
    in_halves_of_unknowns([&](std::size_t kind, std::size_t i, Share half) {
      start_values_.keep(kind, i, unknowns_[kind][i], half);
    });
    start_values_.learn();
    in_halves([&](Share half) { W1_.store(W1, half); });
  } else {
    start_values_.forget();
  }
  return {.status = report.status,
          .attempt = attempt,
          .sweeps = report.sweeps,
          .last_change = report.change,
          .contraction = report.contraction,
          .products = products() - products_before,
          .poisson_solves = poisson_solves() - solves_before,
          .equivalent_products = equivalent_products() - equivalents_before};
}

}  // namespace isosyrk

// The tuned constants of the solver, and those that several fast forms share.
#pragma once

#include <algorithm>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The tuned constants of the solver, and those that several fast forms share.  A constant of one
/// form alone stands in its own file, with what was measured.  These were measured in the cells of
/// Table 2 (50 steps of 0.1 of the smooth scene, s = 1, 2, 3) and in runs of 2000 steps of both
/// scenes, on processors with AVX2 and with AVX-512.
struct Tuning {
  // Inexact Newton.
  /// Largest change of a Picard sweep that is corrected.  For larger changes the Jacobian is a poor
  /// model.  At twice this value, corrections diverge at h‖B‖ = 1.9; at half, cold starts take one
  /// more sweep.
  double largest_corrected = 0.3;
  /// Initial estimate of the contraction of a Picard sweep near the solution, and of the factor by
  /// which the coupling K contracts.
  double likely_contraction = 0.1;
  /// Number of Picard sweeps that are taken in place of a correction where they converge.  At n =
  /// 17 three cost less than a correction; at n = 33 one does.  Where a correction is accepted by
  /// its estimated error, it saves sweeps at any n, and one is the number.
  int sweeps_for_a_correction(Index n) const { return n < 24 ? 3 : 1; }
  /// The forcing term is the error allowed in a correction of a residual R: the largest of
  /// forcing_relative ‖R‖, the limit of single precision, forcing_of_tolerance times the tolerance,
  /// and forcing_quadratic ‖R‖².  Half or twice the last two changes the time of no cell of Table 1
  /// by more than 3 %.
  double forcing_relative = 1e-6;
  double forcing_of_tolerance = 0.3;
  /// The same for systems that are accepted by the estimated error, where no further sweep reduces
  /// what a correction leaves.  At 0.3 exponential methods take up to 5 % more products, at 0.8 the
  /// same (elp4, elp6 at 1e-8, n = 33, 65, 129, T = 5); the energy of 4000 steps of 0.5 is the same
  /// at 0.3 and 0.6 (n = 33, smooth and rough).
  double forcing_of_estimate = 0.6;
  double forcing_quadratic = 0.1;
  /// The Jacobian may have the relative error jacobian_share · forcing term / ‖R‖.
  double jacobian_share = 0.3;
  /// The accuracy of G is this part of the tolerance: any sweep may be accepted.
  double accepting_accuracy = 0.1;
  /// The same for systems that are accepted by the estimated error, which has room for it.  At 0.1
  /// exponential methods take 1 to 3 % more products, at 0.3 up to 9 % more in single cells, where
  /// the estimate then fails (elp4, elp6 at 1e-8, n = 33, 65, 129, T = 5).
  double accepting_accuracy_of_estimate = 0.2;
  /// Accuracy of each term of a Neumann series, as a part of the forcing term.  At 0.4 exponential
  /// methods take up to 4 % more products, at 1 up to 2 % fewer, and answers err alike (elp4, elp6
  /// at 1e-8, n = 33, 65, 129, T = 5).  The energy of 4000 steps of 0.5 shows a difference at 1
  /// alone (n = 33, rough: elp6 4.3e-7 at 1, 2.4e-7 and 2.8e-7 at 0.4 and 0.7).
  double neumann_term = 0.7;
  /// Largest growth of the change from one frozen sweep to the next before T counts as not
  /// contracting.  T is not normal, so its norm may exceed 1.
  double growth = 4.0;
  /// Largest number of inner sweeps of a correction.
  int inner_sweeps = 60;
  /// Frozen sweeps after each Picard sweep, in an attempt of Iteration::frozen_picard.
  int frozen_sweeps = 1;

  // The predictor.
  /// Number of past steps.  More steps predict better, but each costs a pass over memory.  24
  /// instead of 12 saves one sweep in five at n = 65 and 129.  From n = 192 on it costs more than
  /// it saves.
  int past_steps(Index n) const { return n < 48 ? 16 : n < 192 ? 24 : 12; }

  // Band truncation.
  /// Smallest n at which band truncation saves more than measuring the bands costs.
  Index smallest_banded = 48;
  /// Frobenius norm that may be cut from a factor, as a multiple of the tolerance.
  double left_out = 0.01;

  // Single precision.
  /// A matrix is formed in single precision where this multiple of its norm is below the wanted
  /// error.
  double single_roundoff = 6e-8;

  // Threads.
  /// Returns the number of threads in use where so many are asked for: at most one for every so
  /// many entries of a matrix, so two from n = 96 and sixteen from n = 272 on.  Two take 0.9 to 1.4
  /// times the time of one at n = 33 to 65, and 0.6 to 0.9 of it at n = 97 (algebra1, group2, elp4,
  /// rk8, magnus5, rough); more than two were not tried.
  int threads(Index n, int asked) const {
    constexpr Index entries_of_thread = 96 * 96 / 2;
    return static_cast<int>(std::clamp<Index>(n * n / entries_of_thread, 1, std::max(asked, 1)));
  }
};

inline constexpr Tuning tuning{};

}  // namespace isosyrk

// The tuned constants of the fast forms, together.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Every constant that was chosen by measurement.  Where: the cells of Table 2 (50 steps of 0.1 of the
/// smooth scene, s = 1, 2, 3) and runs of 2000 steps of both scenes, on processors with AVX2 and with
/// AVX-512.
struct Tuning {
  // Inexact Newton.
  /// Largest change of a Picard sweep that is corrected.  Beyond it the Jacobian says too little: at
  /// twice this, corrections of h‖B‖ = 1.9 diverge; at half of it, cold starts take a sweep more.
  double largest_corrected = 0.3;
  /// First guess of the contraction of a Picard sweep near the solution, and of the coupling.
  double likely_contraction = 0.1;
  /// The forcing term: the error left in a correction, of its size, of the tolerance, and of the size
  /// squared.  Single precision carries the first; half or twice the others change the time of no
  /// cell by more than 3 %.
  double of_size = 1e-6;
  double of_tolerance = 0.3;
  double of_size_squared = 0.1;
  /// Accuracy of the Jacobian, of the forcing term.
  double of_forcing_term = 0.3;
  /// Growth of a frozen sweep that still counts as contracting: T is not normal.
  double growth = 4.0;
  /// Most inner sweeps of a correction.
  int inner_sweeps = 60;
  /// Frozen sweeps that a Picard iteration adds to each of its own.
  int frozen_sweeps = 1;

  // The predictor.
  /// Past steps that are read.  More predict better, but cost a pass over memory each: 24 for 12
  /// saves a sweep in five at n = 65 and 129, and costs more than it saves from n = 192 on.
  int past_steps(Index n) const { return n < 48 ? 16 : n < 192 ? 24 : 12; }
  /// The difference of the unknowns that is predicted by fitted weights; 4 to 12 err alike.
  static constexpr int differences = 6;
  /// Rows of each unknown that the weights are fitted to; twice as many predict no better.
  Index sampled_rows = 4;
  /// Fewest fitted weights: one predicts no better than the polynomial through one step more.
  int fewest_weights = 2;

  // Band truncation.
  /// Smallest n at which measuring bands costs less than it saves.
  Index smallest_banded = 48;
  /// What may be left out of a factor, of the tolerance.
  double left_out = 0.01;
  /// Least band of the coupling K of a form: beyond it Δ⁻¹ damps the contribution below single
  /// precision.  With half of these a smooth scene needs a third sweep.
  struct CouplingBand {
    Index floor;
    double of_n;
    Index operator()(Index n) const {
      const auto part = static_cast<Index>(of_n * static_cast<double>(n));
      return part > floor ? part : floor;
    }
  };
  CouplingBand cotangent_coupling = {32, 0.375};
  CouplingBand group_coupling = {16, 0.125};
  CouplingBand algebra_coupling = {32, 0.375};
  CouplingBand midpoint_coupling = {24, 0.125};

  // The midpoint's inverse by Newton's (Schulz's) iteration.
  int inverse_iterations = 12;
  /// What is cut of it, of the accuracy asked for.
  double of_inverse = 0.1;

  // Threads.
  /// Smallest n at which threads pay, with one stage and with more.
  Index smallest_parallel(Index stages) const { return stages == 1 ? 96 : 48; }
};

inline constexpr Tuning tuning{};

}  // namespace isosyrk

// What a long run leaves while it goes: snapshots, a series, and a checkpoint to go on from.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "benchmarks/integrate/checkpoint.h"
#include "benchmarks/integrate/integrate_arguments.h"
#include "benchmarks/integrate/series.h"
#include "benchmarks/integrate/snapshots.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk {

/// A run while it goes.  All of it is in a checkpoint.
struct RunSoFar {
  RunReport report = {};  ///< of all steps since t = 0
  double seconds = 0.0;   ///< CPU time of these
  ConservationWatch watch;
  std::unique_ptr<Integrator> integrator;

  void archive(StateArchive& run);
};

/// Returns H as a number, NaN where no double holds it.
double number_of(const Energy& energy);

/// The files of a run with --every: at t = 0, every K steps and at the end a row of the series and
/// a snapshot, and then, if they are seldom enough to cost a twentieth of the time at most, a
/// checkpoint.  There is one at t = 0 and one where a run ends or is interrupted.
class Record {
 public:
  /// Checks what is asked for, and makes no file.  Throws BadArgument for files that cannot be
  /// written, or that a run has written with which this one does not go on.
  explicit Record(const IntegrateRequest& request);

  /// Returns the checkpoint that --resume goes on from, or none.
  const std::optional<Checkpoint>& checkpoint() const { return checkpoint_; }

  /// Begins the files, or takes up the run and its files where the checkpoint left them.  `command`
  /// is what the run is asked for, as far as its steps depend on it.  Throws BadArgument if the
  /// checkpoint is that of another command.
  void begin(const nlohmann::ordered_json& command, RunSoFar& run);
  /// To be called after every step; `is_last` where a run ends before its last step.
  void observe(RunSoFar& run, bool is_last);

 private:
  using Clock = std::chrono::steady_clock;

  void require_same(const nlohmann::ordered_json& command) const;
  void add_row_and_snapshot(RunSoFar& run);
  void write_checkpoint(RunSoFar& run);
  void archive(StateArchive& state, RunSoFar& run);

  const IntegrateRequest& request_;
  std::optional<SnapshotFolder> folder_;
  std::optional<SeriesFile> series_;
  std::optional<Checkpoint> checkpoint_;
  nlohmann::ordered_json command_;
  Matrix W_;
  Clock::time_point next_checkpoint_;
};

}  // namespace isosyrk

#include "benchmarks/integrate/record.h"

#include <fmt/format.h>

#include <limits>

#include "benchmarks/integrate/whole_file.h"
#include "benchmarks/program.h"

namespace isosyrk {
namespace {

// Time from the end of one checkpoint to the begin of the next, in units of what the first took.
constexpr int checkpoint_interval = 19;

}  // namespace

double number_of(const Energy& energy) {
  return energy.is_double() ? energy.value() : std::numeric_limits<double>::quiet_NaN();
}

void RunSoFar::archive(StateArchive& run) { run.pass(report, seconds, watch, *integrator); }

Record::Record(const IntegrateRequest& request) : request_(request) {
  if (request.snapshots_folder) folder_.emplace(*request.snapshots_folder);
  if (request.series_file) series_.emplace(*request.series_file, request.snapshots_folder);
  if (request.resume) {
    checkpoint_.emplace(folder_->checkpoint());
    return;
  }
  if (folder_ && folder_->holds_a_run()) {
    throw BadArgument(
        fmt::format("--snapshots {}: holds a run; --resume goes on with it, or name another folder",
                    *request.snapshots_folder));
  }
  if (series_ && series_->exists()) {
    throw BadArgument(fmt::format("--series {}: is there already; {}name another file",
                                  *request.series_file,
                                  folder_ ? "--resume goes on with its run, or " : ""));
  }
}

// A longer --time goes on, too.  Threads, --output and --json change no step.
void Record::require_same(const nlohmann::ordered_json& command) const {
  const CheckpointHeader& header = checkpoint_->header();
  if (header.step > request_.steps) {
    checkpoint_->refuse(fmt::format("is of step {}, beyond --time {}", header.step, request_.time));
  }
  for (const auto& [key, value] : command.items()) {
    const nlohmann::ordered_json written = header.command.value(key, nlohmann::ordered_json());
    if (written == value) continue;
    if (key == "kernels") {
      print_error("integrate", fmt::format("note: {} is of other kernels ({}): the run goes on to "
                                           "rounding, not bit for bit",
                                           checkpoint_->path().string(), written.dump()));
      continue;
    }
    checkpoint_->refuse(
        fmt::format("is of a run with {} {}, not {}", key, written.dump(), value.dump()));
  }
}

void Record::archive(StateArchive& state, RunSoFar& run) {
  state.pass(run);
  SeriesFile::Position position = series_ ? series_->position() : SeriesFile::Position();
  state.pass(position);
  if (state.is_reading() && series_) series_->resume(position);
}

void Record::begin(const nlohmann::ordered_json& command, RunSoFar& run) {
  command_ = command;
  W_ = run.integrator->state();
  if (checkpoint_) {
    require_same(command);
    checkpoint_->read([&](StateArchive& state) { archive(state, run); });
    next_checkpoint_ = Clock::now();
    return;
  }
  if (folder_) folder_->make();
  if (series_) series_->begin();
  add_row_and_snapshot(run);
  if (folder_) write_checkpoint(run);
}

void Record::observe(RunSoFar& run, bool is_last) {
  const long step = run.report.steps;
  const bool is_due = step % *request_.every == 0 || step == request_.steps;
  if (is_due) add_row_and_snapshot(run);
  is_last |= step == request_.steps;
  if (folder_ && (is_last || (is_due && Clock::now() >= next_checkpoint_))) write_checkpoint(run);
}

void Record::add_row_and_snapshot(RunSoFar& run) {
  run.integrator->state(W_);
  const long step = run.report.steps;
  if (series_) {
    const double error = W_.allFinite() ? run.watch.report(W_).spectrum_error
                                        : std::numeric_limits<double>::quiet_NaN();
    series_->append({.t = static_cast<double>(step) * request_.step,
                     .energy = number_of(run.integrator->energy()),
                     .spectrum_error = error,
                     .enstrophy = 0.5 * W_.squaredNorm(),
                     .sweeps = run.report.sweeps,
                     .seconds = run.seconds});
  }
  if (folder_) folder_->write(step, W_);
}

// The rows that it counts are on the disk before it is.
void Record::write_checkpoint(RunSoFar& run) {
  const Clock::time_point begun = Clock::now();
  if (series_) send_to_disk(series_->path());
  isosyrk::write_checkpoint(folder_->checkpoint(), {.step = run.report.steps, .command = command_},
                            [&](StateArchive& state) { archive(state, run); });
  const Clock::time_point ended = Clock::now();
  next_checkpoint_ = ended + checkpoint_interval * (ended - begun);
}

}  // namespace isosyrk

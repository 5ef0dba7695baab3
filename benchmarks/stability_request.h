// Command line and progress of the stability studies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/output_file.h"
#include "benchmarks/progress.h"
#include "isosyrk/catalogue/integrator_list.h"

namespace isosyrk {

struct StabilityRequest {
  StabilityRequest() = default;
  StabilityRequest(StabilityRequest&&) = default;  // `integrators` may point into `fast_forms`
  StabilityRequest& operator=(StabilityRequest&&) = default;

  std::vector<Index> sizes;
  std::vector<IntegratorEntry> fast_forms;  ///< under the names of the published ones
  std::vector<const IntegratorEntry*> integrators;
  BackendChoice products;
  long processes;
  std::optional<OutputFile> output;
};

/// The options that both studies have.
class StabilityOptions {
 public:
  /// Declares them; `quick` says what --quick does.
  StabilityOptions(CommandLine& line, const std::string& quick);

  /// Declares --solver too.
  void allow_fast_forms(CommandLine& line);

  /// Throws BadArgument or std::invalid_argument.
  StabilityRequest read(const std::vector<Index>& default_sizes,
                        const std::vector<Index>& quick_sizes) const;

  bool quick() const { return quick_; }
  /// "published" or "fast".
  const std::string& solver() const { return solver_; }

 private:
  void choose_integrators(StabilityRequest& request) const;

  std::vector<std::string> sizes_, integrators_;
  std::string products_ = "fastest";
  std::string solver_ = "published";
  std::string processes_;
  std::string out_;
  bool quick_ = false;
};

/// Progress over jobs.
class JobProgress {
 public:
  explicit JobProgress(std::size_t jobs) : jobs_(jobs) {}
  void finished(const std::string& job);

 private:
  std::size_t jobs_;
  std::size_t done_ = 0;
  Progress progress_;
};

}  // namespace isosyrk

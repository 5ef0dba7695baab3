// The operations of one flow in split-complex storage, in both precisions.
#pragma once

#include "isosyrk/fast/split_lie.h"

namespace isosyrk {

/// Products, B and bracket of a flow in both precisions, counted together and cut to the same
/// bands.  What the parts of an exponential system compute with.  Must stay where it is made.
struct SplitOperations {
  /// Throws std::invalid_argument for a flow without a generator in split-complex storage, and for
  /// threads out of range.
  SplitOperations(const Flow& flow, bool truncates, int threads)
      : products(flow.size(), threads),
        single_products(flow.size(), threads),
        generator(flow),
        bands(truncates, 1, flow.size()),
        lie(products, generator, bands),
        single_lie(single_products, generator, bands) {}
  SplitOperations(const SplitOperations&) = delete;
  SplitOperations& operator=(const SplitOperations&) = delete;

  /// Returns the size n of the matrices.
  Index size() const { return products.size(); }
  /// Returns the work since construction.
  Work work() const { return work_of(products, single_products, generator); }
  void archive_work(StateArchive& run) { run.pass(products, single_products, generator); }

  SplitProducts products;
  SingleProducts single_products;
  StageGenerator generator;
  BandTruncation bands;
  SplitLie<double> lie;
  SplitLie<float> single_lie;
};

}  // namespace isosyrk

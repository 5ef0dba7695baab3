// What a step may use of past steps.
#pragma once

namespace isosyrk {

/// Whether a step belongs to a run.
enum class Past {
  used,      ///< past steps predict this one, and it joins them
  left_out,  ///< the step is not of the run: it starts cold and is not remembered
};

}  // namespace isosyrk

// What time is measured by.
#pragma once

namespace isosyrk {

/// CPU seconds used by this process so far (all threads).
double cpu_seconds();

/// Seconds that pass, since some fixed moment.
double wall_seconds();

}  // namespace isosyrk

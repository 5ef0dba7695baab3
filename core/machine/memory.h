// The memory that a program can have, so that a run too large for it is refused before it starts.
#pragma once

#include <filesystem>
#include <string>

#include "isosyrk/catalogue/integrator_list.h"

namespace isosyrk {

/// What this process can still allocate, and what sets that limit.
struct MemoryLimit {
  double bytes;        ///< infinite where nothing is known
  std::string source;  ///< "the machine", "the cgroup", "the limit of this process (ulimit -v)"
};

/// The least of MemAvailable in /proc/meminfo, of memory.max (version 2) or memory.limit_in_bytes
/// (version 1) less what is used, of this process's cgroup and every one above it, and of
/// RLIMIT_AS less the present size, in which OpenBLAS's buffers are after a first product.  Of what
/// a cgroup uses, file pages do not count: the kernel drops them for whoever asks.  `root` is where
/// proc and sys/fs/cgroup are looked for.
MemoryLimit available_memory(const std::filesystem::path& root = "/");

/// Returns about the bytes that an integrator of n x n matrices takes: those of one that is made
/// for at most 96 x 96, scaled.  They are right to a tenth if the past steps of a fast form do not
/// depend on n (with_defaults).  What other threads allocate at that moment may count.
double integrator_bytes(const IntegratorEntry& integrator, Index n);

/// Throws std::invalid_argument for a run with this integrator, of n x n matrices, that needs more
/// memory than there is, for which the kernel would kill it.  The message begins with `what`.
/// Throws as require_memory_of_blas, too.
void require_memory(const std::string& what, const IntegratorEntry& integrator, Index n);

/// Throws std::invalid_argument if the limit of this process leaves no room for the buffers that
/// OpenBLAS takes at its first product.  OpenBLAS does not fail without that room: it tries for
/// ever.  How much it takes depends on its release, so a product is formed in a copy of this
/// process, and then here.  Does nothing where there is no limit.
void require_memory_of_blas();

}  // namespace isosyrk

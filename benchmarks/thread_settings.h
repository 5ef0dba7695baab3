// What the threads of a program are told before it begins.
#pragma once

namespace isosyrk {

/// Replaces this program by itself, with the same arguments, where its environment differs in
/// settings that OpenMP and OpenBLAS read when they are loaded, before main():
///
///     GOMP_SPINCOUNT        Threads spin for some microseconds at a barrier and then sleep.  By
///                           default they spin for milliseconds.  On a busy machine the thread that
///                           they wait for has no core meanwhile.  A value that the user has set
///                           stays, and so does OMP_WAIT_POLICY.
///     OPENBLAS_NUM_THREADS  1: no program here uses more, and each would take a buffer of 128 MB.
///
/// Returns if nothing differs, or if the program cannot be started anew.
void restart_with_thread_settings(char** argv);

}  // namespace isosyrk

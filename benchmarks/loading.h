// What a program does before its libraries are loaded.
#pragma once

namespace isosyrk {

/// Sees to it that a program ends where the limit of its address space (ulimit -v) leaves no room
/// for the buffers that OpenBLAS takes while it is loaded.  Release 0.3.29 takes some; without room
/// OpenBLAS does not fail, it tries for ever.  If loading takes a quarter of a second of CPU time,
/// this prints one line that begins with `program` and exits with exit_bad_arguments.
///
/// Restarts the program as restart_with_thread_settings, since each thread would take a buffer.
/// Does nothing where there is no limit.  To be called before the constructors of libraries, with
/// the arguments that a function in .preinit_array gets.
void guard_loading(const char* program, char** argv, char** environment);

/// Ends the guard: main() has been reached.
void end_guard_of_loading();

}  // namespace isosyrk

"""Builds of the project in other folders, that take what the build under test has compiled already."""

import os

from programs import BUILD

# In place of the compiler: an object that the build under test has is copied, and a precompiled header, of a hundred
# megabytes, is linked to.
LAUNCHER = """#!/bin/sh
previous=
for argument; do
  [ "$previous" = -o ] && output=$PWD/$argument
  previous=$argument
done
found=$COMPILED/${output#"$TARGET_BUILD"/}
case $output in
  *.o) [ -f "$found" ] && exec cp "$found" "$output" ;;
  *.gch) [ -f "$found" ] && exec ln -sf "$found" "$output" ;;
esac
exec "$@"
"""


def launcher(folder, build):
    """Writes the launcher in a folder; returns the option of CMake and the environment for a build in `build`."""
    path = os.path.join(folder, "launcher")
    with open(path, "w", encoding="ascii") as file:
        file.write(LAUNCHER)
    os.chmod(path, 0o755)
    return (f"-DCMAKE_CXX_COMPILER_LAUNCHER={path}",
            {"COMPILED": os.path.realpath(BUILD), "TARGET_BUILD": os.path.realpath(build)})

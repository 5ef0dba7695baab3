"""What the tests that run programs and scripts from outside share. Standard library only, Python 3.9 or later."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import pty
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("ISOSYRK_BUILD") or os.path.join(ROOT, "build")
DATA = os.path.join(ROOT, "tests", "data")
MEASURE, RENDER = (os.path.join(ROOT, "scripts", name) for name in ("measure", "render"))
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts"))  # its modules are tested from inside, too

DONE, BAD_ARGUMENTS, SOLVER_FAILED = 0, 2, 3
PATIENCE = 180  # seconds: longer than whatever is waited for takes on a busy machine
FORMULATIONS = ("cotangent", "group", "algebra")


def text_of(*path):
    with open(os.path.join(*path), encoding="utf-8") as stream:
        return stream.read()


def is_built_with(option):
    """Tells whether an option such as ISOSYRK_SANITIZE was on; ctest says so in the environment."""
    if os.environ.get(option):
        return os.environ[option] == "1"
    cache = os.path.join(BUILD, "CMakeCache.txt")
    return os.path.exists(cache) and f"\n{option}:BOOL=ON\n" in text_of(cache)


SANITIZED = is_built_with("ISOSYRK_SANITIZE")  # n > 33 takes too long
HAS_MODULE = os.path.isdir(os.path.join(BUILD, "python", "isosyrk"))


def program(name):
    return os.path.join(BUILD, "benchmarks", name)


def environment(**changes):
    """Returns this environment without what steers OpenBLAS and Google Benchmark; None removes a variable.

    A choice of OpenBLAS's kernels stays: all processes of a test round alike, and the suite can be run under each.
    """
    steering = ("OPENBLAS_", "OMP_", "BENCHMARK_")
    result = {name: value for name, value in os.environ.items()
              if not name.startswith(steering) or name == "OPENBLAS_CORETYPE"}
    result["LC_ALL"] = "C"
    # Scripts run in the Python that runs the tests: what a version manager puts on PATH in its place takes longer to
    # start than most of them take to run.
    result["PATH"] = os.pathsep.join((os.path.dirname(os.path.realpath(sys.executable)),
                                      result.get("PATH", os.defpath)))
    for name, value in changes.items():
        if value is None:
            result.pop(name, None)
        else:
            result[name] = value
    return result


def default_signals():
    """Undoes what a background job inherits: there SIGINT is ignored, and so would a test's be."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def run(command, timeout=PATIENCE, env=None, prepare=None, **streams):
    """Runs a command to its end; its output is text. `prepare` is called in the child before it starts."""
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams}
    return subprocess.run(command, timeout=timeout, env=env or environment(), preexec_fn=prepare, check=False,
                          encoding="utf-8", errors="replace", **streams)


def run_script(script, *arguments):
    """Runs one of the project's scripts to its end, as run() does, in the Python that runs the tests."""
    return run([sys.executable, "-B", script, *arguments])


def call_script(script, *arguments):
    """Returns what run_script() does of a script that ends before it prints an answer, called in this process."""
    loader = importlib.machinery.SourceFileLoader(os.path.basename(script), script)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    from lib.programs import command_line  # only now: not every test has the scripts on its path
    with contextlib.redirect_stdout(io.StringIO()) as printed, contextlib.redirect_stderr(io.StringIO()) as said:
        try:
            command_line.run(loader.name, module.main, list(arguments))
            status = DONE
        except SystemExit as ended:
            status = ended.code
    return subprocess.CompletedProcess([script, *arguments], status, printed.getvalue(), said.getvalue())


def run_on_full_disk(command, **options):
    with open("/dev/full", "w", encoding="utf-8") as full:
        return run(command, stdout=full, **options)


def start(command, env=None, **streams):
    """Starts a command as leader of a process group of its own, as a terminal does."""
    streams = {"stdin": subprocess.DEVNULL, **streams}
    return subprocess.Popen(command, env=env or environment(), preexec_fn=default_signals, start_new_session=True,
                            encoding="utf-8", errors="replace", **streams)


def open_terminal(test):
    """Returns both ends of a terminal; skips a test where the system has none, as a bare chroot without /dev/pts."""
    try:
        return pty.openpty()
    except OSError as problem:
        return test.skipTest(f"this system has no terminal: {problem}")


def cpu_seconds_of(process):
    """Returns the CPU time of a started process and of its threads, in steps of a clock tick."""
    fields = text_of(f"/proc/{process.pid}/stat").rpartition(")")[2].split()
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


def end(process):
    """Ends what is left of a started process and its group."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()
    for stream in (process.stdout, process.stderr):
        if stream:
            stream.close()


def strict_json(text):
    """Parses exactly one JSON value; a bare NaN or a repeated key is an error, as other readers have it."""
    def refuse(constant):
        raise ValueError(f"{constant} is not JSON")

    def unique(pairs):
        if len({key for key, _ in pairs}) != len(pairs):
            raise ValueError("a key stands twice")
        return dict(pairs)

    return json.loads(text, parse_constant=refuse, object_pairs_hook=unique)


def snapshot(folder):
    """Returns every file under a folder with its bytes, and every folder, hidden ones too."""
    found = {}
    for place, folders, files in os.walk(folder):
        for name in folders:
            found[os.path.relpath(os.path.join(place, name), folder)] = None
        for name in files:
            path = os.path.join(place, name)
            if os.path.isfile(path):
                with open(path, "rb") as stream:
                    found[os.path.relpath(path, folder)] = stream.read()
    return found


class FolderTest(unittest.TestCase):
    """Every test has a folder of its own, removed at its end."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="isosyrk-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, contents, executable=False):
        path = self.path(name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as stream:
            stream.write(contents if isinstance(contents, bytes) else contents.encode("utf-8"))
        if executable:
            os.chmod(path, 0o755)
        return path

    @contextlib.contextmanager
    def unchanged(self):
        """Whatever is done meanwhile leaves every file of the folder as it was, and none besides."""
        before = snapshot(self.folder)
        yield
        self.assertEqual(snapshot(self.folder), before)

    def assert_one_line(self, text, *parts):
        self.assertEqual(text.count("\n"), 1, f"not exactly one line: {text!r}")
        self.assertTrue(text.endswith("\n"), f"not a whole line: {text!r}")
        for part in parts:
            self.assertIn(part, text)

    def assert_refused(self, result, *parts):
        """Exit 2, nothing on stdout, and one line on stderr with every one of `parts` in it."""
        self.assertEqual(result.returncode, BAD_ARGUMENTS, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assert_one_line(result.stderr, *parts)

"""Print a table of the linear solves: our factorisation beside MKL PARDISO and SciPy's SuperLU, on the same tangents.

Run it from any folder with ``python benchmarks/linear.py [--quick] [--divisions 8 66 148]``; it needs ``pypardiso``.
What is timed, and what biases it, is in ``benchmarks/README.md``.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from abc import ABC, abstractmethod
from importlib import import_module
from pathlib import Path

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

import ancf

FloatArray = NDArray[np.float64]

# Elements along each side of a square plate: up to 2.4e3, then 1e4, 4e4, 2e5 and 1e6 free coordinates.
DIVISIONS = (2, 4, 8, 16, 33, 66, 148, 333)
QUICK = (2, 8)
# What a solver may take, as the speed of ours is judged: bytes, and seconds for all of its repeats.
MEMORY = 12 * 2**30
PATIENCE = 1200.0
THREADS = ("RAYON_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
SECONDS = 2.0  # of repeats
MOST_REPEATS = 300


def plate(n: int) -> ancf.Model:
    """Make a square steel plate, clamped at one edge and loaded at the opposite one."""
    material = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)
    rectangle = ancf.Rectangle(size=(0.5, 0.5), divisions=(n, n), thickness=0.001, material=material)
    return ancf.Model(
        bodies={"plate": rectangle},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
    )


class Solver(ABC):
    """Numeric factorisation of a tangent and solution with it; everything else is done when it is made."""

    @abstractmethod
    def __init__(self, system: Path) -> None: ...

    @abstractmethod
    def factorise(self) -> None:
        """Factorise the matrix."""

    @abstractmethod
    def solve(self) -> FloatArray:
        """Solve with the factorisation."""


class Ours(Solver):
    """The factorisation that every solve of ours uses."""

    def __init__(self, system: Path) -> None:
        self.core = plate(int(system.stem)).assemble("ramp")
        q = self.core.reference()
        self.right = self.core.external_force(q, 1.0)
        self.free = self.core.free()
        # The values of the tangent stay in place; the copy of it in Python is not needed.
        self.core.tangent(q, 1.0)

    def factorise(self) -> None:
        """Factorise the matrix."""
        self.core.factorize()

    def solve(self) -> FloatArray:
        """Solve with the factorisation."""
        return self.core.solve(self.right)[self.free]


class Pardiso(Solver):
    """MKL PARDISO with its defaults: METIS, and L L^T, which fails where a tangent is indefinite."""

    ANALYSE, FACTORISE, SOLVE = 11, 22, 33
    kind = 2  # symmetric, positive definite

    def __init__(self, system: Path) -> None:
        # The wrapper's own calls copy the indices each time, which would count.
        self.pardiso = import_module("pypardiso").PyPardisoSolver(mtype=self.kind)
        matrix, self.right = load(system)
        self.arrays = [matrix.data, matrix.indptr.astype(np.int32) + 1, matrix.indices.astype(np.int32) + 1]
        self.solution = np.zeros_like(self.right)
        self.call(self.ANALYSE)

    def call(self, phase: int) -> None:
        """Do a phase."""
        pardiso = self.pardiso
        whole = {k: ctypes.c_int32(k) for k in (0, 1, self.right.size, phase)}
        one, kind, error = whole[1], ctypes.c_int32(self.kind), ctypes.c_int32(0)

        def pointer(array: NDArray[np.generic], to: type = ctypes.c_int32) -> object:
            return array.ctypes.data_as(ctypes.POINTER(to))

        values, begins, columns = self.arrays
        handle = pointer(pardiso.pt, ctypes.c_int64)
        system = (pointer(values, ctypes.c_double), pointer(begins), pointer(columns), pointer(pardiso.perm))
        sides = (pointer(self.right, ctypes.c_double), pointer(self.solution, ctypes.c_double))
        pardiso._mkl_pardiso(
            handle, one, one, kind, whole[phase], whole[self.right.size], *system,
            one, pointer(pardiso.iparm), whole[0], *sides, ctypes.byref(error),
        )  # fmt: skip
        if error.value:
            raise RuntimeError(f"PARDISO failed with error {error.value} in phase {phase}")

    def factorise(self) -> None:
        """Factorise the matrix."""
        self.call(self.FACTORISE)

    def solve(self) -> FloatArray:
        """Solve with the factorisation."""
        self.call(self.SOLVE)
        return self.solution


class IndefinitePardiso(Pardiso):
    """The same for symmetric indefinite matrices: L D L^T with pivoting in supernodes, and refinement."""

    kind = -2


class SuperLU(Solver):
    """SciPy's SuperLU, told that the matrix is symmetric."""

    def __init__(self, system: Path) -> None:
        upper, self.right = load(system)
        self.matrix = (upper + scipy.sparse.triu(upper, 1).T).tocsc()

    def factorise(self) -> None:
        """Factorise the matrix."""
        self.lu = scipy.sparse.linalg.splu(
            self.matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )

    def solve(self) -> FloatArray:
        """Solve with the factorisation."""
        solution: FloatArray = self.lu.solve(self.right)
        return solution


PARDISO = "PARDISO, LLT"
ONE_THREAD = ("SuperLU",)  # whatever they are given
SOLVERS: dict[str, type[Solver]] = {
    "ancf": Ours,
    PARDISO: Pardiso,
    "PARDISO, LDLT": IndefinitePardiso,
    "SuperLU": SuperLU,
}


def save(n: int, folder: Path) -> tuple[Path, int]:
    """Write the tangent and the load of the plate, the upper triangle by rows; return the number of coordinates too."""
    core = plate(n).assemble("ramp")
    q = core.reference()
    free = core.free()
    rows, columns, values = core.tangent(q, 1.0)
    number = np.zeros(q.size, dtype=np.int32)
    # Row by row as a mesh generator numbers them: the others order for themselves.
    natural = np.sort(free)
    number[natural] = np.arange(natural.size, dtype=np.int32)
    i, j = number[rows], number[columns]
    upper = i <= j
    matrix = scipy.sparse.csr_matrix((values[upper], (i[upper], j[upper])), shape=(free.size, free.size))
    path = folder / f"{n}.npz"
    np.savez(
        path, data=matrix.data, indices=matrix.indices, indptr=matrix.indptr, right=core.external_force(q, 1.0)[natural]
    )
    return path, natural.size


def load(path: Path) -> tuple[scipy.sparse.csr_matrix, FloatArray]:
    """Read what was saved."""
    with np.load(path) as arrays:
        right = arrays["right"]
        matrix = scipy.sparse.csr_matrix((arrays["data"], arrays["indices"], arrays["indptr"]), shape=2 * right.shape)
    return matrix, right


def measure(name: str, system: Path) -> dict[str, float]:
    """Time a solver in this process."""
    before = peak()
    # On one thread the processor's time counts, which others on the machine disturb least.
    clock = time.process_time if os.environ[THREADS[0]] == "1" else time.perf_counter
    start = time.perf_counter()
    solver = SOLVERS[name](system)
    setup = time.perf_counter() - start
    factorisations: list[float] = []
    solutions: list[float] = []
    begin = time.perf_counter()
    while not factorisations or (time.perf_counter() - begin < SECONDS and len(factorisations) < MOST_REPEATS):
        start = clock()
        solver.factorise()
        factorisations.append(clock() - start)
        start = clock()
        solution = solver.solve()
        solutions.append(clock() - start)
    size = float(np.abs(solution).max())
    return {
        "setup": setup, "factorise": min(factorisations), "solve": min(solutions), "size": size,
        "n": solution.size, "memory": peak() - before,
    }  # fmt: skip


def peak() -> float:
    """Return the most memory that this process has held, MB."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return float(status.split("VmHWM:")[1].split()[0]) / 1024


def limit_memory() -> None:
    """Let this process take no more than a solver may."""
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def run(name: str, system: Path, threads: int) -> dict[str, float] | str:
    """Time a solver in a process of its own, or say why that did not work."""
    command = [sys.executable, __file__, "--one", name, str(system)]
    environment = os.environ | dict.fromkeys(THREADS, str(threads))
    try:
        process = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=PATIENCE,
            preexec_fn=limit_memory,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"not done after {PATIENCE:.0f} s"
    if process.returncode:
        print(f"{name} on {system.stem} x {system.stem}: {process.stderr.strip()[-300:]}", file=sys.stderr)
        return f"failed within {MEMORY / 2**30:.0f} GiB"
    found: dict[str, float] = json.loads(process.stdout)
    return found


def row(*cells: str) -> None:
    """Print a row of the table."""
    print(f"| {' | '.join(cells)} |", flush=True)


def milliseconds(seconds: float) -> str:
    """Write a time with three digits, or to the millisecond."""
    return f"{1e3 * seconds:.3g}" if seconds < 0.1 else f"{1e3 * seconds:.0f}"


def rows(system: Path, n: int, threads: int, repeats: int) -> None:
    """Print what the solvers take for a system of ``n`` coordinates."""
    names = [name for name in SOLVERS if name not in ONE_THREAD or threads == 1]
    runs: dict[str, list[dict[str, float]]] = {name: [] for name in names}
    failures: dict[str, str] = {}
    for _ in range(repeats):
        for name in [name for name in names if name not in failures]:
            outcome = run(name, system, threads)
            if isinstance(outcome, str):
                failures[name] = outcome
            else:
                runs[name].append(outcome)
    best = {name: {key: min(r[key] for r in found) for key in found[0]} for name, found in runs.items() if found}
    sizes = [found["size"] for found in best.values()]
    if sizes and max(sizes) > 1.0001 * min(sizes):
        raise SystemExit(f"the solvers disagree: {best}")
    other = best.get(PARDISO)
    for name in names:
        if (found := best.get(name)) is None:
            row(f"{n}", f"{threads}", name, failures[name], "", "", "", "")
            continue
        both = found["factorise"] + found["solve"]
        ratio = f"{both / (other['factorise'] + other['solve']):.2f}" if other else ""
        times = [milliseconds(found[key]) for key in ("factorise", "solve", "setup")]
        row(f"{n}", f"{threads}", name, times[0], times[1], ratio, times[2], f"{found['memory']:.0f}")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Time our factorisation, PARDISO and SuperLU.")
    parser.add_argument("--quick", action="store_true", help="see that it runs: small meshes")
    parser.add_argument("--divisions", type=int, nargs="+", help="elements along each side")
    parser.add_argument("--threads", type=int, nargs="+", help="numbers of threads")
    parser.add_argument("--repeats", type=int, default=1, help="processes of each solver, of which the best counts")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one[0], Path(arguments.one[1]))))
        return
    divisions = arguments.divisions or (QUICK if arguments.quick else DIVISIONS)
    with tempfile.TemporaryDirectory() as folder:
        row(
            "coordinates",
            "threads",
            "solver",
            "factorise, ms",
            "solve, ms",
            "both, of PARDISO's",
            "setup, ms",
            "memory, MB",
        )
        print("|---|---|---|---|---|---|---|---|")
        for n in divisions:
            system, coordinates = save(n, Path(folder))
            for threads in arguments.threads or (1, os.cpu_count() or 1):
                rows(system, coordinates, threads, arguments.repeats)
            system.unlink()


if __name__ == "__main__":
    main()

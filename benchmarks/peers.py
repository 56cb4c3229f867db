"""Print our speed beside Exudyn's thin plate, on the same models in the same run.

Run it from any folder with ``python benchmarks/peers.py [--quick]``. Exudyn comes from the package index into an
environment of its own in this folder, or is taken from the present one if it is there. What is timed, and what biases
it, is in ``benchmarks/README.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
import venv
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

CORES = os.cpu_count() or 1
EXUDYN = "exudyn==1.13.6"
ENVIRONMENT = Path(__file__).parent / ".exudyn"
THREADS = ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

# The steel cantilever and the rubber pendulum of Dufva and Shabana (2005).
STEEL: dict[str, Any] = {"size": (0.5, 0.15), "thickness": 0.001, "E": 2.07e11, "nu": 0.3, "density": 7810.0}
RUBBER: dict[str, Any] = {"size": (0.3, 0.3), "thickness": 0.01, "E": 1e5, "nu": 0.3, "density": 7810.0}
UNTIL = 0.3
OUTPUTS = 5  # of Exudyn's pendulum, as in a chart
# Project Chrono 10 with MKL PARDISO, one thread, as quoted to us; not measured here: the package index lacks it.
QUOTED = (
    ("tangent of an element, us", "14 (3423), 35 (3443)"),
    ("force of an element, us", "3.7 to 6.5"),
    ("factorisation, 64 x 64 elements, ms", "94 (3423), 518 (3443)"),
    ("8 x 8 pendulum, step 1e-3, s", "1.7 (3423), 2.8 (3443)"),
)


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    kernel_mesh: int
    factor_mesh: int
    steps: tuple[float, ...]  # of implicit methods in the pendulum, s
    explicit_steps: tuple[float, ...]  # of Exudyn's explicit one: up to the largest with which it is stable
    finest: float  # step of the run that stands for the exact motion in time, s
    cantilever: tuple[int, int]
    pendulum_mesh: int = 8


FULL = Effort(
    kernel_mesh=32,
    factor_mesh=64,
    steps=(4e-3, 2e-3, 1e-3, 5e-4),
    explicit_steps=(7e-4, 3e-4),
    finest=1e-4,
    cantilever=(32, 8),
)
QUICK = Effort(
    kernel_mesh=4,
    factor_mesh=8,
    steps=(1e-2, 5e-3),
    explicit_steps=(1e-3,),
    finest=2e-3,
    cantilever=(4, 1),
    pendulum_mesh=2,
)


def clock() -> float:
    """Return the time: on one thread the processor's, which others on the machine disturb least."""
    return time.process_time() if os.environ[THREADS[0]] == "1" else time.perf_counter()


def seconds(work: Callable[[], object], repeats: int = 1) -> float:
    """Time a call: the least of some."""
    times = []
    for _ in range(repeats):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


# What follows runs in a process of its own, for one program, on some number of threads.


class Ours:
    """Our side."""

    def __init__(self, threads: int) -> None:
        self.ancf = import_module("ancf")
        self.threads = threads

    def cantilever(self, divisions: tuple[int, int], force: float, membrane: str) -> Any:
        """Make the cantilever with a force on its end."""
        ancf, width = self.ancf, STEEL["size"][1]
        return ancf.Model(
            bodies={"plate": self.plate(STEEL, divisions, membrane)},
            supports=[ancf.Support(at="edge:x0", clamp=True)],
            loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -force / width))],
        )

    def plate(self, data: dict[str, Any], divisions: tuple[int, int], membrane: str) -> Any:
        """Make a plate."""
        material = self.ancf.Material(E=data["E"], nu=data["nu"], density=data["density"])
        return self.ancf.Rectangle(
            size=data["size"], divisions=divisions, thickness=data["thickness"], material=material, membrane=membrane
        )

    def kernels(self, n: int, reduced: bool) -> dict[str, float]:
        """Time force and tangent; the reduced rule's like is the membrane on Lobatto points."""
        plate = self.plate(RUBBER, (n, n), "lobatto" if reduced else "full")
        model = self.ancf.Model(bodies={"plate": plate}, loads=[self.ancf.Gravity(acceleration=(0, 0, -9.81))])
        core = model.assemble("constant")
        q = core.reference()
        q += 1e-3 * np.random.default_rng(0).normal(size=q.size)
        core.internal_force(q)  # makes the tables
        force = seconds(lambda: core.internal_force(q), 20)
        # A force and a tangent for each factorisation, and a force at the start and one at the end.
        runs = [
            self.ancf.simulate(model, until=1e-4, step=1e-4, outputs=[1e-4], threads=self.threads) for _ in range(9)
        ]
        both = min((run.seconds["assembly"] - 2 * force) / run.counts["factorizations"] for run in runs)
        return {"force": force / n**2, "tangent": both / n**2}

    def factorisation(self, n: int) -> dict[str, float]:
        """Time the factorisation of the cantilever's tangent at rest."""
        core = self.cantilever((n, n), 1.0, "projected").assemble("ramp")
        q = core.reference()
        core.tangent(q, 1.0)
        return {"factorise": seconds(core.factorize, 10)}

    def statics(self, divisions: tuple[int, int], membrane: str) -> dict[str, float]:
        """Time the way to the equilibrium at 30 N, the making of the system included."""
        model = self.cantilever(divisions, 30.0, membrane)
        self.ancf.solve_static(model, threads=self.threads)
        result = None

        def work() -> None:
            nonlocal result
            result = self.ancf.solve_static(model, threads=self.threads)

        took = seconds(work, 5)
        assert result is not None
        tip = result.positions("plate", [STEEL["size"]])[-1, 0]
        return {"seconds": took, "z": float(tip[2])}

    def pendulum(self, n: int, options: dict[str, Any]) -> dict[str, Any]:
        """Time the motion of the pendulum, the making of the system included."""
        ancf = self.ancf
        model = ancf.Model(
            bodies={"plate": self.plate(RUBBER, (n, n), "lobatto")},
            supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
            loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        )
        result = None

        def work() -> None:
            nonlocal result
            result = ancf.simulate(model, until=UNTIL, outputs=[UNTIL], threads=self.threads, **options)

        took = seconds(work, 5)
        assert result is not None
        return {"seconds": took, "tip": result.positions("plate", [RUBBER["size"]])[-1, 0].tolist()}


class Exudyn:
    """Exudyn's side; ``reduced`` is its rule with 3 x 3 Lobatto points for the membrane and 2 x 2 Gauss for bending."""

    def __init__(self, threads: int) -> None:
        self.exudyn, self.shells = import_module("exudyn"), import_module("exudyn.shells")
        self.items = import_module("exudyn.itemInterface")
        self.threads = threads

    def plate(self, data: dict[str, Any], divisions: tuple[int, int], reduced: bool) -> Any:
        """Make a plate."""
        self.container = self.exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        x, y = data["size"]
        mesh = self.shells.ShellMesh(
            vertices=[[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0]],
            numberOfElementsX=divisions[0],
            numberOfElementsY=divisions[1],
            youngsModulus=data["E"],
            poissonsRatio=data["nu"],
            density=data["density"],
            thickness=data["thickness"],
        )
        mesh.CreateANCFThinPlateElements(self.system, useReducedOrderIntegration=int(reduced))
        return mesh

    def cantilever(self, divisions: tuple[int, int], force: float, reduced: bool) -> Any:
        """Make the cantilever with a force on its end."""
        mesh = self.plate(STEEL, divisions, reduced)
        for node in mesh.boundaryNodeNumbers["left"]:
            self.shells.AddClampToGround(self.system, node)
        self.shells.ApplyEdgeLoad(self.system, mesh, "right", loadVector=[0, 0, -force], distributed=True)
        self.system.Assemble()
        return mesh

    def settings(self) -> Any:
        """Return settings for all solves."""
        settings = self.exudyn.SimulationSettings()
        settings.linearSolver.solverType = self.exudyn.LinearSolverType.EigenSparse
        settings.solution.file.write = False
        settings.parallel.numberOfThreads = self.threads
        return settings

    def kernels(self, n: int, reduced: bool) -> dict[str, float]:
        """Time force and tangent, and what Python takes to call them."""
        mesh = self.plate(RUBBER, (n, n), reduced)
        self.shells.AddSphericalJointToGround(self.system, mesh.vertexNodeNumbers[0])
        self.system.Assemble()
        solver = self.exudyn.MainSolverStatic()
        solver.InitializeSolver(self.system, self.settings())
        force = seconds(lambda: solver.ComputeODE2RHS(self.system), 5)
        tangent = seconds(lambda: solver.ComputeJacobianODE2RHS(self.system), 3)
        return {"force": force / n**2, "tangent": tangent / n**2}

    def factorisation(self, n: int) -> dict[str, float]:
        """Take it from a step of the pendulum, whose Newton iterations each factorise.

        Only the build that is not the fast one has timers; the linear solver is the same library.
        """
        self.pendulum(n, {"step": 1e-3, "modified": False, "until": 1e-3, "timers": True})
        solver = self.system.sys["dynamicSolver"]
        return {"factorise": solver.timer.factorization / solver.it.newtonJacobiCount}

    def statics(self, divisions: tuple[int, int]) -> dict[str, float]:
        """Take the fewest load steps that lead there, with full and with modified Newton: the best counts.

        The making of the system is included.
        """
        best = {"seconds": np.inf, "z": np.nan}
        for modified in (False, True):
            for steps in (1, 2, 4, 8, 16):
                start = clock()
                mesh = self.cantilever(divisions, 30.0, True)
                settings = self.settings()
                settings.staticSolver.numberOfLoadSteps = steps
                settings.staticSolver.newton.useModifiedNewton = modified
                settings.staticSolver.verboseMode = 0
                try:
                    self.system.SolveStatic(settings)
                except Exception:  # how Exudyn says that it did not converge
                    continue
                took = clock() - start
                if took < best["seconds"]:
                    tip = self.tip(mesh)
                    best = {"seconds": took, "z": tip[2], "load steps": steps, "modified": modified}
                break
        return best

    def tip(self, mesh: Any) -> list[float]:
        """Position of the corner at the end of both sides."""
        position = self.exudyn.OutputVariableType.Position
        return [float(x) for x in self.system.GetNodeOutput(mesh.vertexNodeNumbers[2], position)]

    def pin(self, node: int, explicit: bool) -> None:
        """Hold a node: by a joint, or by constraints of coordinates, which explicit methods can eliminate."""
        if not explicit:
            self.shells.AddSphericalJointToGround(self.system, node)
            return
        ground = self.system.AddNode(self.items.NodePointGround())
        fixed = self.system.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for coordinate in range(3):
            own = self.system.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
            self.system.AddObject(self.items.CoordinateConstraint(markerNumbers=[fixed, own]))

    def pendulum(self, n: int, options: dict[str, Any]) -> dict[str, Any]:
        """Time the motion of the pendulum, the making of the system included; corner and middle at `OUTPUTS` times."""
        start, wall = clock(), time.perf_counter()
        mesh = self.plate(RUBBER, (n, n), options.get("reduced", True))
        explicit = options.get("explicit", False)
        self.pin(mesh.vertexNodeNumbers[0], explicit)
        for element in mesh.elementNumbers:
            marker = self.system.AddMarker(self.items.MarkerBodyMass(bodyNumber=element))
            load = self.items.LoadMassProportional(markerNumber=marker, loadVector=[0, 0, -9.81])
            self.system.AddLoad(load)
        # On odd meshes that node is not quite the middle.
        nodes = {"A": mesh.vertexNodeNumbers[2], "B": mesh.nodeNumbers[(n // 2) * (n + 2)]}
        position = self.exudyn.OutputVariableType.Position
        sensors = {
            name: self.system.AddSensor(
                self.items.SensorNode(nodeNumber=node, outputVariableType=position, storeInternal=True)
            )
            for name, node in nodes.items()
        }
        self.system.Assemble()
        settings = self.settings()
        settings.timeIntegration.endTime = until = options.get("until", UNTIL)
        settings.timeIntegration.numberOfSteps = round(until / options["step"])
        settings.timeIntegration.newton.useModifiedNewton = options.get("modified", False)
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.verboseMode = 0
        settings.solution.sensors.writePeriod = until / OUTPUTS
        settings.show.computationTime = options.get("timers", False)
        types = self.exudyn.DynamicSolverType
        solver = types.VelocityVerlet if explicit else types.GeneralizedAlpha
        self.system.SolveDynamic(settings, solverType=solver)
        took = {"seconds": clock() - start, "wall": time.perf_counter() - wall}
        stored = {name: self.system.GetSensorStoredData(sensor).tolist() for name, sensor in sensors.items()}
        return took | {"tip": self.tip(mesh), "probes": stored}


# What follows starts these processes and compares.


def python_with_exudyn() -> str:
    """Return a Python that has Exudyn: this one, or that of an environment made for it."""
    if subprocess.run([sys.executable, "-c", "import exudyn"], capture_output=True, check=False).returncode == 0:
        return sys.executable
    python = ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(ENVIRONMENT, with_pip=True)
    install = [str(python), "-m", "pip", "install", "--quiet", EXUDYN]
    if subprocess.run(install, check=False).returncode:
        raise SystemExit(
            f"{EXUDYN} cannot be installed here, so there is nothing to compare with: see pip's message above"
        )
    return str(python)


class Program:
    """A program that is timed in processes of its own."""

    def __init__(self, name: str, python: str) -> None:
        self.name = name
        self.python = python

    def __call__(self, task: str, *arguments: Any, threads: int = 1, fast: bool = True) -> dict[str, Any]:
        """Run a task and return what it found."""
        command = [
            self.python,
            __file__,
            "--task",
            self.name,
            task,
            json.dumps(arguments),
            str(threads),
            str(int(fast)),
        ]
        environment = os.environ | dict.fromkeys(THREADS, str(threads))
        process = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if process.returncode:
            raise SystemExit(f"{self.name} failed with {task} {arguments}:\n{process.stderr[-2000:]}")
        found: dict[str, Any] = json.loads(process.stdout.strip().splitlines()[-1])
        return found


def task(name: str, what: str, arguments: str, threads: str, fast: str) -> None:
    """Do a task in this process and print what it found."""
    if name == "exudyn":
        sys.exudynFast = bool(int(fast))  # type: ignore[attr-defined]
    program: Ours | Exudyn = Ours(int(threads)) if name == "ancf" else Exudyn(int(threads))
    values = [tuple(value) if isinstance(value, list) else value for value in json.loads(arguments)]
    print(json.dumps(getattr(program, what)(*values)))


def row(what: str, unit: str, ours: float, theirs: float, note: str = "") -> None:
    """Print a row of the table."""
    print(f"| {what} | {unit} | {ours:.3g} | {theirs:.3g} | {theirs / ours:.0f} | {note} |", flush=True)


def kernels(ours: Program, theirs: Program, effort: Effort) -> None:
    """Compare elements and the factorisation."""
    for threads in (1, CORES):
        for reduced, rule in ((False, "default rule"), (True, "reduced rule")):
            a, b = (program("kernels", effort.kernel_mesh, reduced, threads=threads) for program in (ours, theirs))
            unit = f"us per element, {threads} thread{'s' if threads > 1 else ''}"
            row(f"force, {rule}", unit, 1e6 * a["force"], 1e6 * b["force"])
            row(f"tangent, {rule}", unit, 1e6 * a["tangent"], 1e6 * b["tangent"], "ours with the force")
    b = theirs("factorisation", effort.factor_mesh, threads=1, fast=False)
    for threads in (1, CORES):
        a = ours("factorisation", effort.factor_mesh, threads=threads)
        what = f"factorisation, {effort.factor_mesh} x {effort.factor_mesh}"
        row(what, f"ms, {threads} for ours", 1e3 * a["factorise"], 1e3 * b["factorise"], "theirs on one thread")


def statics(ours: Program, theirs: Program, effort: Effort) -> None:
    """Compare the cantilever at 30 N."""
    for threads in (1, CORES):
        b = theirs("statics", effort.cantilever, threads=threads)
        newton = "modified" if b.get("modified") else "full"
        for membrane in ("lobatto", "projected"):
            a = ours("statics", effort.cantilever, membrane, threads=threads)
            what = "{} x {} cantilever, 30 N, `{}`".format(*effort.cantilever, membrane)
            note = (
                f"deflection {a['z']:.5f} and {b['z']:.5f} m; theirs: {b.get('load steps')} load steps, {newton} Newton"
            )
            row(what, f"s, {threads} thread{'s' if threads > 1 else ''}", a["seconds"], b["seconds"], note)


OUR_METHODS: dict[str, dict[str, Any]] = {
    "HHT": {"alpha": -0.05, "reuse": False},
    "HHT, reuse": {"alpha": -0.05, "reuse": True},
    "TR-BDF2": {"method": "tr_bdf2"},
}
OUR_CONTROLLED: dict[str, dict[str, Any]] = {
    "HHT": {"method": "hht", "reuse": True},
    "ESDIRK": {"method": "esdirk", "reuse": True},
    "Verlet": {"method": "verlet"},
}
TOLERANCES = (1e-2, 1e-3, 1e-4)
THEIR_METHODS = {"modified Newton": {"modified": True}, "full Newton": {"modified": False}}


def our_settings(effort: Effort) -> dict[str, dict[str, Any]]:
    """Return what is run of ours: fixed steps, and steps with controlled error."""
    fixed = {f"{name}, step {h:g}": how | {"step": h} for name, how in OUR_METHODS.items() for h in effort.steps}
    controlled = {f"{name}, rtol {r:g}": how | {"rtol": r} for name, how in OUR_CONTROLLED.items() for r in TOLERANCES}
    return fixed | controlled


def their_settings(effort: Effort) -> dict[str, dict[str, Any]]:
    """Return what is run of Exudyn's: implicit with either Newton method, and explicit, all with fixed steps."""
    implicit = {f"{name}, step {h:g}": how | {"step": h} for name, how in THEIR_METHODS.items() for h in effort.steps}
    return implicit | {f"explicit Verlet, step {h:g}": {"explicit": True, "step": h} for h in effort.explicit_steps}


def pendulum(ours: Program, theirs: Program, effort: Effort) -> None:
    """Compare the pendulum where both err alike, each against its own motion converged in time."""
    runs: dict[str, list[tuple[float, float, str]]] = {}
    for program, settings, finest in (
        (ours, our_settings(effort), {"alpha": 0.0, "reuse": True}),
        (theirs, their_settings(effort), {"modified": True}),
    ):
        exact = np.array(program("pendulum", effort.pendulum_mesh, finest | {"step": effort.finest})["tip"])
        found = []
        for how, options in settings.items():
            run = program("pendulum", effort.pendulum_mesh, options)
            error = float(np.linalg.norm(np.array(run["tip"]) - exact))
            found.append((error, run["seconds"], how))
        runs[program.name] = found
    for error, took, how in runs["exudyn"]:
        better = [run for run in runs["ancf"] if run[0] <= error]
        if better:
            own = min(better, key=lambda run: run[1])
            note = f"theirs: {how}, error {1e3 * error:.2g} mm; ours: {own[2]}, {1e3 * own[0]:.2g} mm"
            row(f"{effort.pendulum_mesh} x {effort.pendulum_mesh} pendulum", "s, 1 thread", own[1], took, note)
        else:
            print(f"| pendulum, {how} | s | - | {took:.3g} | - | no run of ours errs less than {1e3 * error:.2g} mm |")
    print("\n| 8 x 8 pendulum, ours | s, 1 thread | error, mm |\n|---|---|---|".replace("8", str(effort.pendulum_mesh)))
    for error, took, how in sorted(runs["ancf"], key=lambda run: run[1]):
        print(f"| {how} | {took:.3g} | {1e3 * error:.2g} |")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Time ancf and Exudyn on the same models.")
    parser.add_argument("--quick", action="store_true", help="see that it runs: small meshes")
    parser.add_argument("--parts", nargs="+", choices=["kernels", "statics", "pendulum"], help="only these")
    parser.add_argument("--task", nargs=5, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.task:
        task(*arguments.task)
        return
    effort = QUICK if arguments.quick else FULL
    ours, theirs = Program("ancf", sys.executable), Program("exudyn", python_with_exudyn())
    print(f"{CORES} cores, {EXUDYN}.\n")
    print("| what | unit | ancf | Exudyn | ratio | note |")
    print("|---|---|---|---|---|---|")
    for part in (kernels, statics, pendulum):
        if not arguments.parts or part.__name__ in arguments.parts:
            part(ours, theirs, effort)
    print("\nProject Chrono 10, quoted, not measured here:\n")
    print("| what | Chrono |")
    print("|---|---|")
    for what, value in QUOTED:
        print(f"| {what} | {value} |")


if __name__ == "__main__":
    main()

"""Memory: what cannot suffice is refused before a run, with what is needed and what there is."""

import subprocess
import sys

import pytest

import ancf
from ancf import memory

GIB = 2**30


def strip(divisions: tuple[int, int], rubber: ancf.Material) -> ancf.Model:
    body = ancf.Rectangle(size=(2.0, 0.2), divisions=divisions, thickness=0.01, material=rubber)
    return ancf.Model(bodies={"strip": body}, supports=[ancf.Support(at="edge:x0", clamp=True)])


def test_a_model_that_does_not_fit(rubber: ancf.Material) -> None:
    with pytest.raises(
        ancf.InputError, match=r"bodies.strip.divisions = \[10000000, 10\]: 9.9e\+08 nodal coordin"
    ) as told:
        strip((10_000_000, 10), rubber).assemble("constant")
    assert "need at least 24.8 GB of memory" in str(told.value)


def test_runs_that_do_not_fit(rubber: ancf.Material, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kind of run is refused only if it needs more than there is."""
    model = strip((40, 4), rubber)
    coordinates = len(model.nodal_coordinates())
    monkeypatch.setattr(memory, "available", lambda: 1000.0 * coordinates)
    refused = r"bodies.strip.divisions = \[40, 4\]: 1.84e\+03 nodal coordinates need at least 0.00203 GB"
    with pytest.raises(ancf.InputError, match=refused):
        ancf.solve_static(model)
    with pytest.raises(ancf.InputError, match=refused):
        ancf.modes(model)
    with pytest.raises(ancf.InputError, match="need at least"):
        ancf.simulate(model, until=1e-5, step=1e-6)
    assert ancf.simulate(model, until=1e-5, step=1e-6, method="verlet").status == "ok"
    with pytest.raises(ancf.InputError, match="need at least"):  # states
        ancf.simulate(model, until=1e-4, step=1e-6, every=1e-6, method="verlet")


def test_the_limit_of_a_process_counts() -> None:
    """In a process of its own, which takes some of it already."""
    code = f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({GIB}, {GIB})); "
    code += "from ancf.memory import available; print(available())"
    limited = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 0 < float(limited.stdout) < GIB


@pytest.mark.parametrize(
    ("method", "divisions"), [("hht", (80, 80)), ("hht", (8000, 1)), ("rk", (80, 80)), ("rk", (8000, 1))]
)
def test_what_is_refused_would_not_fit(method: str, divisions: tuple[int, int]) -> None:
    """A process takes more memory than the bound says it needs at least."""
    code = f"""
import re
import ancf
from ancf import memory
size = lambda name: 1024 * int(re.search(rf"{{name}}:\\s*(\\d+) kB", open("/proc/self/status").read())[1])
start = size("VmRSS")
body = ancf.Rectangle(
    size=(1.0, 1.0), divisions={divisions}, thickness=0.01, material=ancf.Material(E=1e5, nu=0.3, density=1e3)
)
model = ancf.Model(bodies={{"body": body}}, supports=[ancf.Support(at="edge:y0", clamp=True)])
run = dict(until=1e-8, step=1e-8, force=True) if "{method}" == "rk" else dict(until=1e-3, step=1e-3)
ancf.simulate(model, **run, method="{method}", outputs=[], threads=1)
bound = memory.EXPLICIT if "{method}" == "rk" else memory.implicit(body)
print(len(model.nodal_coordinates()) * bound / (size("VmHWM") - start))
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 0.1 < float(told.stdout) < 0.9

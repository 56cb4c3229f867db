"""Every element converges as its page says: the pages show what the script prints, the rates are as they should be."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from ancf.bodies import NODAL_VECTORS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs" / "elements"
FULL = ["full48a", "full48b"]

# Problem, then the range of the rate; both thin elements, all membrane variants. Corners between clamped and free edges
# limit the order, and the strip's stretch, which the elastica leaves out, its error to some 1e-5.
RATES = {
    "thin36": {
        "strip under end shear": (3.0, 5.0),
        "strip bent in its plane": (0.9, 2.0),
        "steel cantilever": (2.0, 3.2),
        "free square, mode 1": (1.7, 2.1),
        "square clamped at one edge, mode 3": (1.8, 2.1),
    },
    "thin48": {
        "strip under end shear": (2.9, 4.2),
        "strip bent in its plane": (0.9, 2.0),
        "steel cantilever": (2.0, 3.2),
        "free square, mode 1": (3.8, 4.1),
        "square clamped at one edge, mode 3": (1.8, 2.2),
    },
}


@pytest.fixture(scope="module")
def printed() -> str:
    script = ROOT / "benchmarks" / "convergence.py"
    return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout


def rows(text: str) -> dict[tuple[str, str], list[float]]:
    """Errors and rate of each problem and membrane variant in a table."""
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
    return {(name, membrane): [float(number) for number in numbers] for name, membrane, *numbers in cells[2:]}


def table(element: str) -> str:
    page = (DOCS / f"{element}.md").read_text(encoding="utf-8")
    match = re.search(r"<!-- convergence -->\n(.*?)<!-- /convergence -->", page, flags=re.DOTALL)
    assert match is not None
    return match[1]


@pytest.mark.parametrize("element", list(NODAL_VECTORS))
def test_every_element_has_its_page_and_picture(element: str) -> None:
    index = (DOCS / "README.md").read_text(encoding="utf-8")
    assert f"[`{element}`]({element}.md)" in index
    page = (DOCS / f"{element}.md").read_text(encoding="utf-8")
    (picture,) = re.findall(r"!\[.*?\]\((.*?)\)", page)
    assert (DOCS / picture).stat().st_size > 10_000
    assert len(re.findall(rf"^\| `{element}` \|", index, flags=re.MULTILINE)) >= 2, "a row of memory, one of errors"


@pytest.mark.parametrize("element", list(NODAL_VECTORS))
def test_pages_show_what_the_script_prints(element: str, printed: str) -> None:
    assert f"{element}\n\n{table(element)}" in printed


def test_the_index_shows_what_the_script_prints(printed: str) -> None:
    match = re.search(
        r"<!-- finest -->\n(.*?)<!-- /finest -->", (DOCS / "README.md").read_text(encoding="utf-8"), flags=re.DOTALL
    )
    assert match is not None
    assert printed.endswith(match[1])


def test_every_element_has_rates() -> None:
    assert [*RATES, *FULL] == list(NODAL_VECTORS)


@pytest.mark.parametrize("element", list(RATES))
def test_rates_of_thin_elements(element: str) -> None:
    for (problem, membrane), (*_, rate) in rows(table(element)).items():
        low, high = RATES[element][problem]
        assert low <= rate <= high, f"{problem}, {membrane}: {rate}"


@pytest.mark.parametrize("element", FULL)
def test_solids_bend_slowly(element: str) -> None:
    """Sixteen elements do worse than two of `thin36`, at order two at best: errors of the shear that bending brings."""
    solid, thin = rows(table(element)), rows(table("thin36"))
    for problem in ("strip under end shear", "steel cantilever"):
        *errors, rate = solid[problem, "none"]
        assert errors[3] > 5 * thin[problem, "projected"][0]
        assert errors[0] > 0.8
        assert 1.0 < rate < 2.1


@pytest.mark.parametrize("element", FULL)
def test_solids_lock_in_thickness(element: str) -> None:
    """With nu = 0.3 the bending stiffness is (1 - nu)^2 / (1 - 2 nu) too high: frequencies by 10.7 %, on any mesh."""
    locked = ((1 - 0.3) ** 2 / (1 - 2 * 0.3)) ** 0.5 - 1
    *_, finest, _ = rows(table(element))["square clamped at one edge, mode 3", "none"]
    assert finest > locked * 0.99


def test_a_middle_surface_without_twist_does_not_twist() -> None:
    """The first mode of a free square is a twist: refining does nothing for `full48b`."""
    *errors, rate = rows(table("full48b"))["free square, mode 1", "none"]
    assert errors[3] > 0.4
    assert rate < 0.1

"""Scene files say the same as Python."""

from pathlib import Path

import ancf
from ancf.run import Dynamic


def test_a_scene_is_the_model_in_python(pendulum: ancf.Model, scenes: Path) -> None:
    scene = ancf.load_scene(scenes / "pendulum.toml")
    assert scene.title == "Small pendulum"
    assert scene.model.bodies == pendulum.bodies
    assert scene.model.supports == pendulum.supports
    assert scene.model.loads == pendulum.loads
    assert scene.model.probes == pendulum.probes
    assert scene.run == ancf.Dynamic(until=0.05, step=5e-3, alpha=-0.05, outputs=[0.025, 0.05])


def test_output_times() -> None:
    def times(**options: object) -> list[float]:
        return Dynamic(until=0.3, step=1e-3, **options).times()  # type: ignore[arg-type]

    assert len(times()) == 101
    assert times()[:2] == [0.0, 0.003]
    assert times()[-1] == 0.3
    assert times(outputs=[0.0, 0.1, 0.2]) == [0.0, 0.1, 0.2]
    assert times(every=0.1) == [0.0, 0.1, 0.2, 0.3]
    assert times(every=0.2) == [0.0, 0.2, 0.3]
    assert times(every=1.0) == [0.0, 0.3]
    assert Dynamic(until=0.3, step=0.1).times()[-1] == 0.3
    assert len(Dynamic(until=0.3, step=0.1).times()) == 4


def test_a_byte_order_mark_is_no_mistake(scenes: Path, tmp_path: Path) -> None:
    path = tmp_path / "marked.toml"
    path.write_bytes(b"\xef\xbb\xbf" + (scenes / "pendulum.toml").read_bytes())
    assert ancf.load_scene(path).title == "Small pendulum"

"""The errors of this package: a wrong input, a run that failed, a run that was stopped."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any, Self

from ancf import _core

Path = tuple[str | int, ...]

_SHOWN = 80


def show(value: object) -> str:
    """Write `value` as a scene file would, cut to one line."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, (list, tuple)):
        text = f"[{', '.join(show(item) for item in value)}]"
    elif isinstance(value, dict):
        text = f"{{{', '.join(f'{key} = {show(item)}' for key, item in value.items())}}}"
    else:
        text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 4]} ..."


def one_of(allowed: Iterable[str], given: object = None) -> str:
    """Say what is allowed, and which of it is nearest to what was given."""
    names = list(allowed)
    if not names:
        return "there is none"
    near = get_close_matches(given, names, n=1) if isinstance(given, str) and len(names) > 1 else []
    hint = f"; did you mean {near[0]}?" if near else ""
    return f"{'allowed are' if len(names) > 1 else 'allowed is'} {', '.join(names)}{hint}"


@dataclass(frozen=True)
class Mistake:
    """One thing that is wrong with an input.

    Parameters
    ----------
    path : tuple of str and int
        Where it is: keys and positions, outermost first.
    message : str
        What is allowed.
    value : str, optional
        What was given, as it is shown; None where nothing was.
    """

    path: Path
    message: str
    value: str | None = None

    def __str__(self) -> str:
        place = ".".join(str(part) for part in self.path)
        given = "" if self.value is None else f" = {self.value}"
        return f"{place}{given}: {self.message}" if self.path else self.message


class InputError(ValueError):
    """An input that cannot be used.

    The message has one line for each mistake: its key path, its value and what is allowed.

    Parameters
    ----------
    *mistakes : Mistake
        All that is wrong, in the order of the input.
    """

    def __init__(self, *mistakes: Mistake) -> None:
        super().__init__(*mistakes)
        self.mistakes = mistakes

    def __str__(self) -> str:
        return "\n".join(str(mistake) for mistake in self.mistakes)

    def under(self, *path: str | int) -> InputError:
        """Return the same error, its paths continued outwards by `path`."""
        return InputError(*(replace(mistake, path=(*path, *mistake.path)) for mistake in self.mistakes))


class Mistakes:
    """Gathers mistakes, so that all of them are told at once."""

    def __init__(self) -> None:
        self._found: list[Mistake] = []

    def add(self, path: Path, message: str, value: object = None) -> None:
        """Note one mistake; a value of None was not given."""
        self._found.append(Mistake(path, message, None if value is None else show(value)))

    @contextmanager
    def gather(self, *path: str | int) -> Iterator[None]:
        """Take up the mistakes that the body of the `with` statement raises, under `path`, and go on."""
        try:
            yield
        except InputError as error:
            self._found.extend(error.under(*path).mistakes)

    def check(self) -> None:
        """Raise `InputError` if there are mistakes."""
        if self._found:
            raise InputError(*self._found)


@contextmanager
def from_core(*path: str | int) -> Iterator[None]:
    """Turn an error of the compiled module into `InputError`, its argument under `path`; so are other `InputError`s."""
    try:
        yield
    except InputError as error:
        raise error.under(*path) from None
    except _core.InputError as error:
        raise InputError(Mistake((*path, error.argument), f"allowed is {error.allowed}", error.value)) from None


class _WithResult(BaseException):
    """What happened, and what the run had by then."""

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[Self], tuple[str, Any]]:
        return type(self), (str(self), self.result)


class SolveError(_WithResult, RuntimeError):
    """A run that failed half way.

    Parameters
    ----------
    message : str
        Where it failed, why, and what to try.
    result : Result or ModalResult
        Every state up to the last good one.
    """


class Interrupted(_WithResult, KeyboardInterrupt):
    """A run or a plan that was stopped from outside, as by Ctrl-C.

    Parameters
    ----------
    message : str
        Where it stopped.
    result : Result, ModalResult or Plan
        Every state up to there, or what was known by then.
    """

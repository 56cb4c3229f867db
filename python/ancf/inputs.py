"""What all inputs share: a frozen, strictly checked class, and the types of its fields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from ancf.errors import InputError, Mistake, one_of, show

_WORDS = {
    "Input should": "must",
    "String should": "must",
    "a valid integer": "a whole number",
    "a valid dictionary": "a table",
    "a valid mapping": "a table",
    "a valid boolean": "true or false",
    "a valid ": "a ",
}


class Input(BaseModel):
    """A frozen set of named values, checked when it is made.

    Python and scene files use the same classes: the keys of a table are the keyword arguments. Lists, tuples and
    arrays are taken alike and kept as tuples.

    Raises
    ------
    InputError
        Lists every unknown or missing name, wrong type and impossible value.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)

    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**{name: _plain(value) for name, value in values.items()})
        except ValidationError as error:
            raise InputError(*_mistakes(error, type(self))) from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return the same input with some values replaced, and checked as any other."""
        return type(self)(**dict(self) | dict(update or {}))

    def document(self) -> dict[str, Any]:
        """Return what makes the same input, in the words of scene files, without what is as by default."""
        tags = {key: getattr(type(self), key) for key in _TAGS if hasattr(type(self), key)}
        return tags | {
            name: _document(value)
            for name, value in self
            if type(self).model_fields[name].is_required() or value != type(self).model_fields[name].default
        }


_TAGS = ("kind", "shape")
"""Class attributes that tell the classes of a table apart."""


def _document(value: Any) -> Any:
    match value:
        case Input():
            return value.document()
        case tuple():
            return [_document(item) for item in value]
        case Mapping():
            return {key: _document(item) for key, item in value.items()}
        case _:
            return value


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    return tuple(_plain(item) for item in value) if isinstance(value, (list, tuple)) else value


def _mistakes(error: ValidationError, owner: type[Input]) -> Iterator[Mistake]:
    for item in error.errors(include_url=False):
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, InputError):
            yield from cause.under(*item["loc"]).mistakes
        else:
            yield Mistake(item["loc"], *_told(item, owner))


def _told(item: ErrorDetails, owner: type[Input]) -> tuple[str, str | None]:
    """Return what is allowed and what was given."""
    shown = show(item["input"])
    context = item.get("ctx", {})
    match item["type"]:
        case "missing":
            return "is missing", None
        case "extra_forbidden":
            return f"unknown key; {one_of(owner.model_fields, item['loc'][-1])}", shown
        case "literal_error":
            allowed = context["expected"].replace("'", "").replace(" or ", ", ").split(", ")
            return one_of(allowed, item["input"]), shown
        case "value_error":
            return str(context["error"]), shown
        case "sequence_str" | "sequence_type" | "tuple_type" | "is_instance_of":
            return "must be a list", shown
        case _:
            message = item["msg"]
            for theirs, ours in _WORDS.items():
                message = message.replace(theirs, ours)
            return message, shown


class OnBody(Input):
    """An input that belongs to one body.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    """

    body: str = ""

    def find_body(self, bodies: Iterable[str]) -> Self:
        """Return the same input with its body filled in, or raise `InputError` if it is not one of `bodies`."""
        names = list(bodies)
        if not self.body:
            if len(names) > 1:
                raise InputError(Mistake(("body",), f"is missing; {one_of(names)}"))
            return self.model_copy(update={"body": names[0]})
        if self.body not in names:
            raise InputError(Mistake(("body",), one_of(names, self.body), show(self.body)))
        return self


def table(*classes: type[Input], key: str | None = None) -> Callable[[Any], Input]:
    """Return a validator that takes an instance of one of `classes`, or a table from which to make one.

    Parameters
    ----------
    *classes : type
        What is allowed.
    key : str, optional
        The entry of a table that names the class, which has it as a class attribute of the same name. Needed unless
        there is just one class.
    """
    names = " or ".join(cls.__name__ for cls in classes)

    def make(value: Any) -> Input:
        if isinstance(value, classes):
            return value
        if not isinstance(value, dict):
            raise InputError(Mistake((), f"must be a table (in Python: {names})", show(value)))
        if key is None:
            return classes[0](**value)
        tags = {getattr(cls, key): cls for cls in classes}
        if key not in value:
            raise InputError(Mistake((key,), f"is missing; {one_of(tags)}"))
        tag = value[key]
        if not isinstance(tag, str) or tag not in tags:
            raise InputError(Mistake((key,), one_of(tags, tag), show(tag)))
        return tags[tag](**{name: item for name, item in value.items() if name != key})

    return make


def whole(name: str, value: object, least: int, most: int) -> int:
    """Return an argument if it is a whole number from `least` to `most`, or raise `InputError`."""
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not least <= value <= most:
        raise InputError(Mistake((name,), f"must be a whole number from {least} to {most}", show(value)))
    return int(value)


def numbers(name: str, values: ArrayLike, *shape: int | str, finite: bool = True) -> NDArray[np.float64]:
    """Take an argument as an array.

    Parameters
    ----------
    name : str
        What the argument is called.
    values : array_like
        Numbers of any type, in any order in the memory.
    *shape : int or str
        The length along each axis; where any will do, what is counted there.
    finite : bool, default True
        Whether all must be finite.

    Returns
    -------
    ndarray
        Contiguous.

    Raises
    ------
    InputError
        If it has another shape, or there is something in it that is no (finite) number.
    """
    wanted = f"({', '.join(map(str, shape))}{',' if len(shape) == 1 else ''})"
    try:
        array = np.asarray(values, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise InputError(Mistake((name,), f"must be an array of numbers of the shape {wanted}", show(values))) from None
    if array.ndim != len(shape) or any(n != m for n, m in zip(array.shape, shape, strict=True) if isinstance(m, int)):
        raise InputError(Mistake((name,), f"must have the shape {wanted}, not {array.shape}"))
    if finite and not np.isfinite(array).all():
        raise InputError(Mistake((name,), "must hold finite numbers only"))
    return array


_SMALLEST, _LARGEST = 1e-30, 1e30
"""What is beyond is no quantity of a structure, and products of such numbers are none at all."""


def _count(number: int) -> BeforeValidator:
    def check(value: Any) -> Any:
        if not isinstance(value, tuple) or len(value) != number:
            raise ValueError(f"must be a list of {number} numbers")
        return value

    return BeforeValidator(check)


def _moderate(value: float) -> float:
    if not _SMALLEST <= value <= _LARGEST:
        raise ValueError(f"must be from {_SMALLEST:g} to {_LARGEST:g}")
    return value


Positive = Annotated[float, Field(gt=0), AfterValidator(_moderate)]
PositiveInt = Annotated[int, Field(gt=0)]
Pair = Annotated[tuple[Positive, Positive], _count(2)]
Divisions = Annotated[PositiveInt, Field(le=2**27)]
PairOfInts = Annotated[tuple[Divisions, Divisions], _count(2)]
Vector = Annotated[tuple[float, float, float], _count(3)]
Point = Annotated[tuple[float, float], _count(2)]

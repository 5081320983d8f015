"""Documents: what a command prints with ``--json``, as objects."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any


if TYPE_CHECKING:
    from ._types import Path


class Record(dict[str, Any]):
    """A part of a document: a ``dict`` whose keys are attributes too.

    >>> ct.Record(rank=49).rank
    49
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"found no {name!r}, expected one of {', '.join(self)}") from None

    @property
    def values(self) -> Any:
        """What the document calls ``values``, where it does; the method of a ``dict`` otherwise."""
        return self["values"] if "values" in self else super().values

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


class Document:
    """A document by attribute and by key; its text is taken apart when it is first asked for something.

    Values are in SI. A number that does not exist is ``None``. The keys are in ``docs/json.md``.

    >>> seen = ct.observe(example)
    >>> seen.rank, seen["columns"]
    (49, 49)
    >>> seen.to_json().startswith('{')
    True
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._content: Record | None = None

    @property
    def content(self) -> Record:
        """The whole document."""
        if self._content is None:
            # Imported late: whoever calibrates alone waits for none of it.
            import json

            self._content = json.loads(self._text, object_hook=Record)
        assert self._content is not None
        return self._content

    def to_json(self, path: Path | None = None) -> str:
        """The text, byte for byte what the command prints; written to ``path`` as UTF-8 if one is given."""
        if path is not None:
            with open(path, "wb") as file:
                file.write(self._text.encode())
        return self._text

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.content, name)

    def __getitem__(self, key: str) -> Any:
        return self.content[key]

    def __contains__(self, key: object) -> bool:
        return key in self.content

    def __iter__(self) -> Iterator[str]:
        return iter(self.content)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.content]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Document) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._text,)

    def __repr__(self) -> str:
        name = self.content.get("schema", self.content.get("title", "document"))
        return f"<{name}: {', '.join(key for key in self.content if key not in ('schema', 'program'))}>"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{escape(key)}</th><td>{shown(value)}</td></tr>" for key, value in self.content.items())
        return f"<table>{rows}</table>"


def escape(text: str) -> str:
    """A text as HTML has it."""
    from html import escape as escaped

    return escaped(text)


def shown(value: Any) -> str:
    """A value in a cell: lists of parts as tables, long ones by their length."""
    rows_at_most = 60
    if isinstance(value, dict):
        rows = "".join(f"<tr><th>{escape(str(key))}</th><td>{shown(part)}</td></tr>" for key, part in value.items())
        return f"<table>{rows}</table>"
    if isinstance(value, list) and value and all(isinstance(part, dict) for part in value) and len(value) <= rows_at_most:
        keys = list(value[0])
        head = "".join(f"<th>{escape(key)}</th>" for key in keys)
        rows = "".join("<tr>" + "".join(f"<td>{shown(part.get(key))}</td>" for key in keys) + "</tr>" for part in value)
        return f"<details><summary>{len(value)}</summary><table><tr>{head}</tr>{rows}</table></details>"
    if isinstance(value, list) and (len(value) > 12 or any(isinstance(part, (list, dict)) for part in value)):
        return f"{len(value)} entries"
    if isinstance(value, list):
        return escape(", ".join(str(part) for part in value))
    return escape("" if value is None else str(value))

"""Which documents go together."""

from __future__ import annotations

from typing import Any


def check_documents(
    html: Any, history: Any, pdf: Any, before: Any, dcc: Any, code: Any, range: Any, laboratory: Any
) -> None:
    """Refuses an argument that does nothing without another one.

    >>> from centrical._documents import check_documents
    >>> check_documents(None, None, "certificate.pdf", None, None, None, None, None)
    Traceback (most recent call last):
    ...
    ValueError: pdf: found no laboratory, expected one: the certificate names it
    """
    needs = [
        ("history", history, "html", html, "the history is a part of the report"),
        ("pdf", pdf, "laboratory", laboratory, "the certificate names it"),
        ("dcc", dcc, "laboratory", laboratory, "the certificate names it"),
        ("before", before, "pdf", pdf, "the certificate shows both results"),
        ("range", range, "code", code, "the range is that of the source code"),
    ]
    for name, value, other, present, reason in needs:
        if value is not None and present is None:
            raise ValueError(f"{name}: found no {other}, expected one: {reason}")

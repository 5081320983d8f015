"""What runs the tasks: threads here that each drive a process, any executor of Python, or a Dask scheduler."""

from __future__ import annotations

import os
import queue
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, Protocol

from .isolation import begin, end_all
from .settings import EnvironmentMismatch, check

QUIET = 0.5
"""How often an engine that says nothing is asked whether it is still there [s]."""


class EngineError(RuntimeError):
    """The engine is not there, or is not there any more."""


class Engine(Protocol):
    """Runs tasks; what each gives, or the error that ended it, comes in any order."""

    def check(self, expected: dict[str, str]) -> None:
        """Refuses workers with another program."""

    def run(self, work: Callable[[Any], Any], tasks: Sequence[Any], names: Sequence[str]) -> Iterator[tuple[int, Any]]:
        """Gives the number of a task and its outcome."""

    def close(self) -> None:
        """Closes what was opened here."""


def engine_of(engine: Any) -> Engine:
    """The engine of an address, an executor, a Dask client, or of nothing: this machine."""
    if engine is None:
        return _Threads(ThreadPoolExecutor(os.cpu_count() or 1), is_own=True)
    if isinstance(engine, Executor):
        return _Threads(engine, is_own=False)
    return _Dask(engine)


class _Threads:
    """An executor. Its own one has threads: the work is done by the process of each."""

    def __init__(self, executor: Executor, is_own: bool) -> None:
        self._executor, self._is_own = executor, is_own

    def check(self, expected: dict[str, str]) -> None:
        self._executor.submit(check, expected).result()

    def run(self, work: Callable[[Any], Any], tasks: Sequence[Any], names: Sequence[str]) -> Iterator[tuple[int, Any]]:
        done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        for number, task in enumerate(tasks):
            future = self._executor.submit(work, task)
            future.add_done_callback(lambda future, number=number: done.put((number, future)))  # type: ignore[misc]
        for _ in tasks:
            number, future = done.get()
            yield number, future.exception() or future.result()

    def close(self) -> None:
        if self._is_own:
            # After the last task nothing is at work; before, the run was interrupted.
            end_all()
            self._executor.shutdown(cancel_futures=True)
            begin()


class _Dask:
    """A scheduler of Dask, by its address or its client."""

    def __init__(self, engine: Any) -> None:
        import distributed

        self._is_own = not isinstance(engine, distributed.Client)
        try:
            self._client = distributed.Client(engine, timeout="20s") if self._is_own else engine
        except (OSError, ValueError) as error:
            raise EngineError(f"{engine}: found no scheduler that answers ({error}), expected one such as tcp://HOST:8786") from error

    def check(self, expected: dict[str, str]) -> None:
        answers = self._client.run(check, expected, on_error="return")
        if not answers:
            raise EngineError("the scheduler has no worker: found 0, expected one or more")
        wrong = [f"{worker}: {answer}" for worker, answer in answers.items() if isinstance(answer, BaseException)]
        if wrong:
            raise EnvironmentMismatch(f"{len(wrong)} of {len(answers)} workers cannot work. {wrong[0]}")

    def run(self, work: Callable[[Any], Any], tasks: Sequence[Any], names: Sequence[str]) -> Iterator[tuple[int, Any]]:
        done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        futures = self._client.map(work, list(tasks), key=list(names), pure=False, retries=2)
        for number, future in enumerate(futures):
            future.add_done_callback(lambda future, number=number: done.put((number, future)))
        for _ in tasks:
            number, future = self._next(done)
            if future.status == "finished":
                yield number, future.result()
            elif future.status == "error":
                yield number, future.exception()
            else:
                raise EngineError(f"the scheduler lost a task ({future.status}); the same command goes on")
            futures[number] = None

    def _next(self, done: queue.SimpleQueue[tuple[int, Any]]) -> tuple[int, Any]:
        while True:
            try:
                return done.get(timeout=QUIET)
            except queue.Empty:
                if self._client.status not in ("running", "newly-created"):
                    raise EngineError("the scheduler does not answer any more; the same command goes on") from None

    def close(self) -> None:
        if self._is_own:
            self._client.close(timeout=5)

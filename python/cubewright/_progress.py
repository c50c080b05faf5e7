"""Progress: reports of long calls, and how Python stops them."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from typing import Any, Optional

from . import _declarations as c
from ._errors import Error, Status, call

Progress = Optional[Callable[[str, float], Any]]
"""A callable of (step, fraction): the step's name, and how much of it is done, 0 to 1.

Returning False cancels the call, which then raises Error with Status.CANCELLED. An exception
that it raises stops the call, too, and comes out of it. None and True go on.
"""

_REPORT: Any = dict(c.cw_progress._fields_)["report"]  # type: ignore[arg-type]


class Reporter:
    """Carries the reports of one call to Python, and an exception back.

    A call without a callback has a reporter as well: the interpreter then notices Ctrl-C.
    """

    def __init__(self, progress: Progress) -> None:
        if progress is not None and not callable(progress):
            raise TypeError(f"progress must be callable or None, not {type(progress).__name__}")
        self.progress = progress
        self.exception: BaseException | None = None
        self.handler: Any = None  # of SIGINT, while a call runs on the main thread
        self.c_report = _REPORT(self.take_report)
        self.struct = c.cw_progress(report=self.c_report)

    def take_report(self, _user: int | None, step: bytes | None, done: float) -> bool:
        if self.exception is not None:
            return False
        if self.progress is None:
            return True
        try:
            answer = self.progress((step or b"").decode("utf-8", "replace"), done)
        except BaseException as exception:
            self.exception = exception
            return False
        return self.exception is None and (answer is None or bool(answer))

    def take_interrupt(self, number: int, frame: Any) -> None:
        """Keeps what the handler of SIGINT raises until the call has ended.

        The interpreter runs a handler as it enters take_report(), before any `try` there. An
        exception would be lost in C.
        """
        try:
            self.handler(number, frame)
        except BaseException as exception:
            self.exception = exception

    def call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Calls as _errors.call() does; an exception of the callback or of Ctrl-C comes first.

        Results need an owner before the call: an interrupt may come after C has made them.
        """
        if threading.current_thread() is threading.main_thread():
            self.handler = signal.getsignal(signal.SIGINT)
        try:
            if callable(self.handler):
                signal.signal(signal.SIGINT, self.take_interrupt)
            call(function, *arguments)
        except Error as error:
            if self.exception is None or error.status != Status.CANCELLED:
                raise
        finally:
            if callable(self.handler):
                signal.signal(signal.SIGINT, self.handler)
            # Ends the circle of reporter, bound method and callback, so that no collector is needed.
            self.c_report = self.struct = self.handler = None  # type: ignore[assignment]
        if self.exception is not None:
            raise self.exception

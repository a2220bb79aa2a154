"""The terminal as a front end: progress with time left, warnings, questions, and Ctrl-C."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from app.cli.interrupts import Interrupts
from app.cli.parameters import Choices, print_difference
from app.cli.remedies import REMEDIES
from app.operations.session import SessionTask, working_on
from core.errors import Cancelled, Remedy, SessionError
from core.imagination.imagination import WORKER_MODULE
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.report.sentences import duration_text
from core.workers import WorkerPool

_PATIENCE_S = 1.5
_LINE_EVERY_S = 2.0


@contextmanager
def working(
    folder: Path,
    choices: Choices,
    workers: int | None,
    is_existing: bool = False,
    terminal: TerminalReporter | None = None,
) -> Iterator[Pipeline]:
    """Start the workers, show progress, and hold the session.

    Args:
        folder: the session's.
        choices: its parameters.
        workers: how many; none: one a processor.
        is_existing: whether to refuse a folder that is no session yet.
        terminal: shows progress; none: a new one.

    Raises:
        SessionError: there is no such session, or another program works on it.
    """
    if is_existing and not folder.exists():
        raise SessionError(f"There is no session {folder}.", Remedy.IMPORT_SCAN)
    preset, chosen = choices.parameters(folder)
    with WorkerPool(workers) as pool, terminal or TerminalReporter() as reporter:
        pool.start(WORKER_MODULE)
        print_difference(preset, chosen)
        with working_on(SessionTask(folder, chosen, preset), pool, reporter, is_existing) as pipeline:
            yield pipeline


class TerminalReporter(Reporter):
    """Shows a bar for each stage on a terminal, and now and then a plain line when stderr is piped."""

    def __init__(self) -> None:
        super().__init__()
        self._console = Console(stderr=True, highlight=False)
        self._bars: dict[str, TaskID] = {}
        self._started_s: dict[str, float] = {}
        self._last_line_s: dict[str, float] = {}
        self._stage = ""
        self._progress: Progress | None = None
        self._leaving: threading.Timer | None = None
        self._interrupts = Interrupts(self._on_interrupt)
        self.warnings: list[str] = []

    def __enter__(self) -> TerminalReporter:
        if self._console.is_terminal:
            self._progress = Progress(
                TextColumn("{task.description:<16}"),
                BarColumn(),
                TextColumn("{task.percentage:>3.0f} %"),
                TimeElapsedColumn(),
                TextColumn("left"),
                TimeRemainingColumn(),
                console=self._console,
            )
            self._progress.start()
        self._interrupts.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        self._interrupts.__exit__(*exception)
        if self._progress is not None:
            self._progress.stop()

    def progress(self, stage: str, done: float, total: float) -> None:
        """Show that `done` of `total` of a stage are finished."""
        # For the first time or once more, as the second cup's pour after the first one's outcome. A stage of
        # several parts in a row goes on after its end, and is told once.
        is_beginning = stage != self._stage and done < total
        self._stage = stage
        if self._progress is None:
            self._print_line(stage, done, total, is_beginning)
            return
        if stage not in self._bars:
            self._bars[stage] = self._progress.add_task(stage, total=total)
        elif is_beginning and self._progress.tasks[self._bars[stage]].finished:
            self._progress.reset(self._bars[stage])
        self._progress.update(self._bars[stage], completed=done, total=total)

    def warn(self, sentence: str) -> None:
        """Show a sentence, and remember it."""
        self.warnings.append(sentence)
        self._console.print(f"Note: {sentence}", style="yellow", markup=False, soft_wrap=True)

    def ask(self, question: str) -> bool:
        """Ask a question that only 'y' or 'yes' answers with yes."""
        return self.ask_text(f"{question} [y/N]").lower() in ("y", "yes")

    def ask_number(self, question: str) -> int | None:
        """Ask for a whole number from 0; none when nothing is entered."""
        while True:
            text = self.ask_text(question)
            if not text:
                return None
            if text.isdecimal():
                return int(text)
            self._console.print("Enter a whole number, such as 3.")

    def ask_text(self, question: str) -> str:
        """Ask for a line of text; the progress bars pause meanwhile."""
        if self._progress is not None:
            self._progress.stop()
        try:
            return self._console.input(f"{question} ", markup=False).strip()
        except EOFError:
            return ""
        finally:
            if self._progress is not None:
                self._progress.start()

    def forget_cancel(self) -> None:
        """Go on: what Ctrl-C was meant to stop has stopped; after SIGTERM nothing goes on.

        Raises:
            Cancelled: it was SIGTERM.
        """
        if self._interrupts.was_terminated:
            raise Cancelled("Ended on request: what moved is at rest where it was stopped.")
        if self._leaving is not None:
            self._leaving.cancel()
        super().forget_cancel()

    def _print_line(self, stage: str, done: float, total: float, is_beginning: bool) -> None:
        now = time.monotonic()
        if self._last_line_s.get(stage) == float("inf"):
            if not is_beginning:
                return  # its last line has been printed
            del self._started_s[stage], self._last_line_s[stage]
        started = self._started_s.setdefault(stage, now)
        is_new, is_done = stage not in self._last_line_s, done >= total
        if not (is_new or is_done or now - self._last_line_s[stage] > _LINE_EVERY_S):
            return
        self._last_line_s[stage] = float("inf") if is_done else now
        fraction = done / total if total else 1.0
        left = ""
        if 0.02 < fraction < 1:
            left = f", about {duration_text((now - started) * (1 - fraction) / fraction)} left"
        print(f"{stage}: {100 * fraction:.0f} %{left}", file=sys.stderr, flush=True)

    def _on_interrupt(self) -> None:
        """Ask the work to stop; what does not respond in time (a long call into C) is abandoned."""
        self.cancel()
        self._leaving = threading.Timer(_PATIENCE_S, self._leave)
        self._leaving.daemon = True
        self._leaving.start()

    def _leave(self) -> None:
        # Workers notice that their parent is gone and end; a half-written stage is removed at the next start.
        sys.stderr.write(f"Stopped on request; finished stages are kept. {REMEDIES[Remedy.CONTINUE]}\n")
        sys.stderr.flush()
        os._exit(1)

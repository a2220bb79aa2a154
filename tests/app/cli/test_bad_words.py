"""Every word and path that the command line takes, given badly: one short sentence, before any work."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from inspect import signature
from itertools import count
from pathlib import Path
from typing import Annotated, Literal, get_args, get_origin, get_type_hints

import pytest
import typer
from typer.models import OptionInfo

from app import cli
from app.cli import options
from app.cli.program import app
from app.cli.remedies import LONGEST_SENTENCE
from core.evaluation.evaluation import write_trial
from core.mesh_file import write_ply
from core.session import Session
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import pour_runs
from hardware.simulation.objects import builtin_object
from tests.core.evaluation.evaluations import small_evaluation
from tests.fuzz.whole_session import make_whole_session

PARSERS = (
    options.given_path,
    options.given_text,
    options.given_word,
    options.written_answer,
    options.written_file,
)
NEVER = {"half a sign": "a\udcff", "zero": "a\0b", "escape": "a\x1b[31m"}
"""What nothing can take."""
WORK = (
    "app.cli.arm_commands.examine",
    "app.cli.evaluation_commands.run_evaluation",
    "app.cli.evaluation_commands.run_tuning",
    "app.cli.evaluation_commands.with_measured_spills",
    "app.cli.evaluation_commands.write_comparison",
    "app.cli.session_commands.bring_report_up_to_date",
    "app.operations.calibration.check.check_cell",
    "app.operations.calibration.cup.reach_of",
    "app.operations.calibration.devices.examine_device",
    "app.operations.calibration.dry_run.connected",
    "app.operations.calibration.hand_eye.calibrate_cell",
    "app.operations.calibration.reference.store_reference",
    "app.operations.calibration.steps.write_board_pdf",
    "app.operations.calibration.table.measure_table",
    "app.operations.calibration.views.choose_views",
    "app.operations.making_objects.members",
    "core.pipeline.pipeline.Pipeline.__init__",
    "hardware.simulation.ur_controller.server.ControllerServer._cycle",
)
"""Where commands begin to work, after they have looked at what they were given."""


class Worked(BaseException):
    """The command took what it was given, and began; nothing catches it."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a command; an argument has no option. Numbers, switches, and one of few are no words.

    Some take several numbers.
    """

    name: str
    option: str | None
    is_required: bool
    parser: Callable[[str], object] | None
    is_word: bool
    n_numbers: int


def parameters_of(callback):
    """The parameters as their annotations declare them."""
    hints = get_type_hints(callback, include_extras=True)
    for name, parameter in signature(callback).parameters.items():
        hint = hints[name]
        while get_origin(hint) is not Annotated:  # wrapped by what has a default of None
            hint = next(one for one in get_args(hint) if one is not type(None))
        kind, info = get_args(hint)[:2]
        option = info.default if isinstance(info, OptionInfo) else None  # its first argument
        is_required = parameter.default is parameter.empty
        is_word = bool({str, Path} & set(kinds(kind)))
        n_numbers = len(get_args(kind)) if get_origin(kind) is tuple else 0
        yield Parameter(name, option, is_required, info.parser, is_word, n_numbers)


def kinds(hint):
    """The types in an annotation; those of single words are no types."""
    if get_origin(hint) is Literal:
        return
    yield hint
    for one in get_args(hint):
        yield from kinds(one)


def commands_of(program, words=()):
    """Every command's parameters, by the words that call it."""
    for one in program.registered_commands:
        name = one.name or one.callback.__name__.replace("_", "-")
        yield (*words, name), tuple(parameters_of(one.callback))
    for group in program.registered_groups:
        yield from commands_of(group.typer_instance, (*words, group.name))


COMMANDS = dict(commands_of(app))
PROGRAM = typer.main.get_command(app)
"""Made once: the commands' declarations are read anew with each call otherwise."""


def words_of(command):
    return [one for one in command if one.is_word]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_each_word_and_path_enters_through_the_options_module(words):
    for one in words_of(COMMANDS[words]):
        assert one.parser in PARSERS, f"{one.name} needs a parser"


def test_the_commands_are_found():
    """Else the others would try nothing."""
    assert ("scan",) in COMMANDS and ("cell", "new") in COMMANDS and ("objects", "make") in COMMANDS
    assert sum(len(words_of(command)) for command in COMMANDS.values()) > 60
    assert {one.name for one in words_of(COMMANDS["evaluate",])} >= {"objects", "out", "labels", "variant"}


class Place:
    """A folder with something good for each parameter, and what is bad for most."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._numbers = count()
        self.session = make_whole_session(root / "whole")
        (root / "objects").mkdir()
        self.mesh = root / "objects" / "mug.ply"
        write_ply(self.mesh, builtin_object("mug"))
        write_ply(root / "objects" / "block.ply", builtin_object("block"))
        (root / "objects" / "labels.csv").write_text("id,label\nmug,container\nblock,non-container\n")
        (root / "evaluated").mkdir()
        evaluation = small_evaluation()
        evaluation.save(root / "evaluated")
        for trial in evaluation.trials:
            write_trial(root / "evaluated", trial, "key")
        os.mkfifo(root / "pipe")
        (root / "file").write_text("x")
        (root / "loop").symlink_to(root / "loop")

    def new(self) -> Path:
        return self.root / f"new-{next(self._numbers)}"

    def good(self, words, name) -> str:
        """What does for a parameter that must be given."""
        if name == "session":
            return str(self.new() if words[0] in ("import", "scan") else self.session)
        known = {
            "source": self.mesh,
            "objects": self.root / "objects",
            "before": self.root / "evaluated",
            "after": self.root / "evaluated",
        }
        return str(known.get(name, self.new()))

    def bad(self) -> dict[str, str]:
        inside = "/".join("folder" * 10 for _ in range(6))
        return NEVER | {
            "empty": "",
            "blank": " ",
            "lines": "a\nb",
            "long": "x" * 300,
            "very long": "x" * 5000,
            "long ending": "x" * 300 + ".json",
            "a file's longest name": "x" * 255,
            "with value": "y" * 300 + "=" + "x" * 5000,
            "pipe": str(self.root / "pipe"),
            "device": "/dev/zero",
            "folder": str(self.root),
            "here": ".",
            "file": str(self.root / "file"),
            "in a file": str(self.root / "file" / "in"),
            "loop": str(self.root / "loop"),
            "no parent": str(self.root / "none" / "none"),
            "deep": str(self.root / inside / "file.json"),
            "proc": "/proc/nothing",
            "proc preset": "/proc/nothing.json",
            "in proc": "/proc/nothing/nothing",
            "memory": "/proc/self/mem",
        }


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        root = tmp_path_factory.mktemp("words")
        for name in ("POURSIGHT_SESSIONS", "POURSIGHT_CELLS", "XDG_CONFIG_HOME"):
            patch.setenv(name, str(root / name.lower()))
        patch.chdir(root)
        yield Place(root)


@pytest.fixture(autouse=True)
def stopped_before_work(monkeypatch):
    def work(*_, **__):
        raise Worked

    for name in WORK:
        monkeypatch.setattr(name, work)
    monkeypatch.setattr("core.workers.WorkerPool.start", lambda *_: None)
    monkeypatch.setattr("app.cli.program.app", PROGRAM)


def said(monkeypatch, *words):
    """Run a command; return its exit code (none: it began to work) and its last line."""
    monkeypatch.setattr(sys, "argv", ["poursight", *words])
    told = io.StringIO()
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(told):
            cli.main()
        code = 0
    except Worked:
        return None, ""
    except SystemExit as leaving:
        code = int(leaving.code or 0)
    return code, told.getvalue().rstrip("\n").rpartition("poursight: ")[2]


def call(place, words, parameter, value):
    """The words of a command of which one is bad."""
    line = [*words]
    if words[0] == "export":
        line += ["--overwrite", "--html", str(place.new())]
    for one in COMMANDS[words]:
        if one is parameter or one.is_required:
            given = value if one is parameter else place.good(words, one.name)
            values = ["1"] * one.n_numbers or [given]
            line += values if one.option is None else [one.option, *values]
    return [*line, "0", "0"] if words[0] == "choose" else line


@pytest.mark.parametrize(
    "words",
    [words for words in COMMANDS if words_of(COMMANDS[words]) and words != ("calibrate",)],  # that is tune
    ids=" ".join,
)
def test_what_is_given_badly_is_refused_in_a_sentence_before_any_work(words, place, monkeypatch):
    for parameter in words_of(COMMANDS[words]):
        for name, value in place.bad().items():
            code, sentence = said(monkeypatch, *call(place, words, parameter, value))
            case = f"{parameter.name}, {name}: {code} {sentence!r}"
            assert code in (None, 0, 1), case
            assert code == 1 or name not in NEVER, case
            if code == 1:
                assert len(sentence) <= LONGEST_SENTENCE and "\n" not in sentence, case
                assert sentence.endswith((".", "?")), case


def test_the_commands_begin_to_work_with_what_is_good(place, monkeypatch):
    """Else nothing above would be about the one bad word."""
    for words in [words for words in COMMANDS if words[0] not in ("cell", "cluster")]:
        more = ["--reason", "Nearer."] if words[0] == "choose" else []
        code, sentence = said(monkeypatch, *call(place, words, None, ""), *more)
        assert code in (None, 0), f"{words}: {sentence}"


def test_what_a_person_wrote_in_lines_can_be_read_again(place, monkeypatch):
    session = str(place.session)
    assert said(monkeypatch, "outcome", session, "--remarks", "One\nrolled\toff: é")[0] == 0
    assert said(monkeypatch, "choose", session, "0", "1", "--reason", "It is\nnearer.")[0] == 0
    assert pour_runs(place.session)[-1].outcome.remarks == "One\nrolled\toff: é"
    pours = Session.open(place.session).record("pouring")
    assert read_operator_choice(place.session, pours.digest).reason == "It is nearer."


@pytest.mark.parametrize("value", ["", "/proc/nothing", "gone/file.json", ".", "x" * 252, "/dev/null"])
@pytest.mark.parametrize(
    "words",
    [
        ("imagine", "objects/mug.ply", "--json"),
        ("export", "whole", "--html"),
        ("export", "whole", "--pdf"),
        ("export", "whole", "--zip"),
        ("compare", "evaluated", "evaluated", "--html"),
        ("tune", "objects", "--spills-from-truth"),
        ("tune", "objects", "--out"),
    ],
    ids=" ".join,
)
def test_a_file_that_cannot_be_written_is_refused_before_any_work(words, value, place, monkeypatch):
    out = ["--out", "good"] if "--spills-from-truth" in words else []
    given = value if value.startswith(("/", ".")) or not value else f"./{value}"
    code, sentence = said(monkeypatch, *words, given, *out)
    assert (code, len(sentence) <= LONGEST_SENTENCE) == (1, True), sentence


def test_a_file_that_is_there_is_not_replaced_and_nothing_is_rendered_before(place, monkeypatch):
    (place.root / "report.html").write_text("mine")
    code, sentence = said(monkeypatch, "export", str(place.session), "--html", "report.html")
    assert code == 1 and "exists already" in sentence
    assert (place.root / "report.html").read_text() == "mine"


def test_the_answer_may_go_to_stdout_from_a_folder_that_takes_no_file(place, monkeypatch):
    monkeypatch.chdir("/proc/self")
    assert said(monkeypatch, "imagine", str(place.mesh), "--json", "-") == (None, "")


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["{long}"], "No such command"),
        (["demo", "--{long}"], "No such option"),
        (["demo", "--workers", "{long}"], "--workers"),
        (["demo", "--seed={lines}"], "--seed"),
        (["evaluate", "objects", "--out=o", "--input", "{long}"], "--input"),
        (["cell", "board", "bench", "--paper", "{long}"], "--paper"),
        (["cell", "board", "bench", "--measured-mm", "{long}"], "--measured-mm"),
        (["demo", *["{long}"] * 9], "unexpected extra argument"),
        (["imagine"], "SESSION|MESH"),
        (["demo", "--workers"], "--workers"),
        (["cell"], "Missing command"),
    ],
)
def test_words_that_no_command_has_are_quoted_in_part(words, named, monkeypatch):
    filled = [word.format(long="x y/" * 2000, lines="1\n" * 400) for word in words]
    code, sentence = said(monkeypatch, *filled)
    assert code == 2
    assert named in sentence and sentence.endswith("--help'."), sentence
    assert len(sentence) <= LONGEST_SENTENCE and "\n" not in sentence, sentence

"""A session for others, as HTML, PDF or one ZIP file, and a session from others, unpacked again.

Each export is written whole or not at all, and replaces nothing unless asked to. A ZIP file that comes in may
be from anybody, so it is not trusted.
"""

from __future__ import annotations

import lzma
import shutil
import stat
import struct
import time
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from os import utime
from pathlib import Path, PurePosixPath
from tempfile import mkdtemp
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from app.library.places import free_folder
from app.library.session_folder import REPORT_FILE, fingerprint, newest_change_ns, session_files
from core.errors import InputError, Remedy, SessionError, StageError
from core.files import check_regular, reason
from core.formats import excerpt
from core.progress import Reporter
from core.session import Session, explained
from core.session.header import HEADER_FILE
from core.workers import Task, WorkerPool

PDF_PACKAGES = ("libpango-1.0-0", "libpangoft2-1.0-0", "libharfbuzz-subset0")
"""Debian's names of what WeasyPrint loads at run time."""

_MOST_UNPACKED = 100
"""Times an archive's size; what unpacks to more is made to fill disks."""
_SMALL_BYTES = 10_000_000
"""As much may be unpacked from any archive."""
_MOST_OF_FREE = 0.9
"""Of the free disk: a full one would stop whatever else runs."""
_DAMAGED = (
    BadZipFile, EOFError, LookupError, NotImplementedError, RuntimeError, ValueError, lzma.LZMAError,
    struct.error, zlib.error,
)  # fmt: skip
"""What `zipfile` and its decompressors raise."""
_PACKED_ALREADY = {".mp4", ".npz", ".png", ".jpg"}


def report_is_current(session: Path) -> bool:
    """Whether a session has a report that is as new as its stages and runs; else write it again first."""
    try:
        return (session / REPORT_FILE).stat().st_mtime_ns >= newest_change_ns(session)
    except OSError:
        return False


def export_html(session: Path, target: Path, overwrite: bool = False) -> None:
    """Copy a session's report, which is one file that needs nothing else.

    Raises:
        InputError: the target cannot be written, or exists and is not to be overwritten.
        SessionError: the session has no report yet.
    """
    report = _report(session)
    with _written_whole(target, overwrite) as unfinished:
        shutil.copyfile(report, unfinished)


def export_model(session: Path, target: Path, overwrite: bool = False) -> None:
    """Write a session's model with its photographed colours as PLY or GLB, by the target's ending.

    Raises:
        InputError: another ending, or the target cannot be written, or exists and is not to be overwritten.
        SessionError: the session has no coloured model.
    """
    from core.mesh_file import colored_mesh_content, read_ply
    from core.reconstruction.colors import COLORS_FILE, ModelColors  # brings Pillow along

    ending = target.suffix.lower()
    if ending not in (".ply", ".glb"):
        raise InputError(f"{target} cannot be written: models are written as .ply or .glb.")
    if not (session / "colors" / COLORS_FILE).is_file():
        raise SessionError(f"{session} holds no coloured model; reconstruct its scan.", Remedy.RUN_AGAIN)
    rgb, mesh = ModelColors.load(session / "colors").rgb, read_ply(session / "reconstruction" / "mesh.ply")
    with _written_whole(target, overwrite) as unfinished:
        unfinished.write_bytes(colored_mesh_content(mesh, rgb, ending))


def export_pdf(
    session: Path, target: Path, pool: WorkerPool, reporter: Reporter, overwrite: bool = False
) -> None:
    """Print a session's report as PDF (A4), in a worker; takes 1 to 3 s.

    Raises:
        InputError: the target cannot be written, or exists and is not to be overwritten.
        SessionError: the session has no report yet.
        StageError: a library that draws text is not installed.
    """
    report = _report(session)
    with _written_whole(target, overwrite) as unfinished:
        pool.run([Task(pdf_job, (report, unfinished))], "export", reporter)


def export_zip(session: Path, target: Path, reporter: Reporter, overwrite: bool = False) -> None:
    """Pack a session's folder into one ZIP file, without locks and unfinished stages.

    Raises:
        InputError: the target cannot be written, or exists and is not to be overwritten.
        SessionError: the folder is no session, cannot be read, or changed meanwhile.
    """
    folder = Session.open(session).path
    before = fingerprint(folder)
    with _written_whole(target, overwrite) as unfinished:
        _pack(folder, unfinished, reporter)
        if fingerprint(folder) != before:
            raise SessionError(f"The session {folder} changed while it was exported; export it again.")


def pdf_job(html_path: Path, target: Path) -> None:
    """Print an HTML file as PDF; to be called in a worker.

    Nothing but what the file itself holds is loaded: a report from elsewhere reaches neither net nor disk.
    """
    import logging

    from PIL import ImageFile

    try:
        import weasyprint
        from weasyprint.urls import URLFetcher
    except OSError as error:
        raise StageError(
            f"The PDF needs a system library that is missing ({str(error).splitlines()[0]}); install it by "
            f"'sudo apt-get install -y {' '.join(PDF_PACKAGES)}', or export HTML."
        ) from error
    # WeasyPrint makes Pillow take cut-off pictures for whole ones; this worker may yet read a scan.
    ImageFile.LOAD_TRUNCATED_IMAGES = False
    logging.getLogger("weasyprint").setLevel(logging.ERROR)  # it notes what only browsers understand
    fetcher = URLFetcher(allowed_protocols=("data",))
    html = weasyprint.HTML(string=html_path.read_text(encoding="utf-8"), url_fetcher=fetcher)
    html.write_pdf(target)


def _report(session: Path) -> Path:
    folder = Session.open(session).path
    if not (folder / REPORT_FILE).is_file():
        raise SessionError(f"The session {folder} has no report yet; write one first.")
    return folder / REPORT_FILE


def _pack(folder: Path, target: Path, reporter: Reporter) -> None:
    files = [(Path(entry.path), entry.stat().st_size) for entry in session_files(folder)]
    total = max(sum(size for _, size in files), 1)
    done = 0
    with ZipFile(target, "w", strict_timestamps=False) as archive:
        for path, size in files:
            reporter.raise_if_cancelled()
            kind = ZIP_STORED if path.suffix in _PACKED_ALREADY else ZIP_DEFLATED
            _add(archive, path, f"{folder.name}/{path.relative_to(folder).as_posix()}", kind)
            done += size
            reporter.progress("export", done, total)


def _add(archive: ZipFile, path: Path, name: str, kind: int) -> None:
    try:
        archive.write(path, name, compress_type=kind)
    except FileNotFoundError as error:
        raise SessionError(f"{path} vanished while the session was exported; export it again.") from error
    except PermissionError as error:
        raise SessionError(f"{path} cannot be read ({error.strerror}); make it readable.") from error


@contextmanager
def _written_whole(target: Path, overwrite: bool) -> Iterator[Path]:
    """Give a hidden file beside the target to write to; at the end it becomes the target."""
    target = target.absolute()
    unfinished = target.with_name(f".{target.name}.part")
    try:
        check_target(target, overwrite)
        try:
            yield unfinished
            unfinished.replace(target)
        finally:
            unfinished.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(
            f"{target} cannot be written ({error.strerror}); name another file or free some space."
        ) from error


def check_target(target: Path, overwrite: bool) -> None:
    """Refuse what an export must not replace, or cannot be written to.

    Raises:
        InputError: it is a folder, lies in none, or exists and is not to be overwritten.
    """
    if target.is_dir():
        raise InputError(f"{target} is a folder; name a file in it.")
    if not target.parent.is_dir():
        raise InputError(f"There is no folder {target.parent}; make it, or name a file elsewhere.")
    if target.exists() and not overwrite:
        raise InputError(f"{target} exists already; name another file, or ask for it to be overwritten.")


def import_zip(archive: Path, root: Path, reporter: Reporter) -> Path:
    """Unpack a session that `export_zip` packed into a new folder, and return it.

    Args:
        archive: the ZIP file.
        root: where to put the session; its folder keeps its name, with a number behind it if that is taken.
        reporter: shows how far it is.

    Raises:
        InputError: the file is no ZIP file, is damaged, or holds something else than one session.
        SessionError: the session in it cannot be opened, or the disk is full.
    """
    try:
        check_regular(archive)
        with ZipFile(archive) as opened:
            members, top = _members(opened, archive)
            _check_free_space(members, root, archive)
            return _unpack(opened, members, top, root, reporter)
    except OSError as error:
        raise InputError(f"{archive} cannot be unpacked into {root} ({reason(error)}).") from error
    except _DAMAGED as error:
        raise InputError(
            f"{archive} is no ZIP file that can be read ({reason(error)}); export it again."
        ) from error


def _members(archive: ZipFile, path: Path) -> tuple[list[ZipInfo], str]:
    """Return the files to unpack and the one folder that all of them are in."""
    members = [member for member in archive.infolist() if not member.is_dir()]
    strange = [member.filename for member in members if not _is_plain(member)]
    if strange:
        raise InputError(f"{path} holds '{excerpt(strange[0])}', which no session does; it is not unpacked.")
    names = {member.filename for member in members}
    tops = {name.partition("/")[0] for name in names}
    top = tops.pop() if len(tops) == 1 else "."
    if top.startswith(".") or f"{top}/{HEADER_FILE}" not in names or len(names) != len(members):
        raise InputError(f"{path} does not hold one session; give a file that Poursight exported.")
    return members, top


def _is_plain(member: ZipInfo) -> bool:
    """Whether a file lies inside of the archive's folder and is a file at all, not a link."""
    name = PurePosixPath(member.filename)
    mode = member.external_attr >> 16
    return (
        bool(name.parts)
        and member.filename.isprintable()
        and not name.is_absolute()
        and ".." not in name.parts
        and not any(sign in member.filename for sign in "\\:\0")
        and (stat.S_IFMT(mode) in (0, stat.S_IFREG))
    )


def _check_free_space(members: Sequence[ZipInfo], root: Path, archive: Path) -> None:
    root.mkdir(parents=True, exist_ok=True)
    needed, free = sum(member.file_size for member in members), shutil.disk_usage(root).free
    if needed > max(_MOST_UNPACKED * archive.stat().st_size, _SMALL_BYTES):
        raise InputError(
            f"{archive} would unpack to {needed / 1e6:.0f} MB, which no session of its size does; it is not "
            "unpacked."
        )
    if needed > _MOST_OF_FREE * free:
        raise InputError(
            f"{archive} needs {needed / 1e6:.0f} MB, but the disk of {root} has {free / 1e6:.0f} MB left; "
            "free some space."
        )


def _unpack(archive: ZipFile, members: Sequence[ZipInfo], top: str, root: Path, reporter: Reporter) -> Path:
    unfinished = Path(mkdtemp(prefix=".importing-", dir=root))
    try:
        with explained(root):
            for number, member in enumerate(members, 1):
                reporter.raise_if_cancelled()
                unpacked = Path(archive.extract(member, unfinished))
                _keep_time(unpacked, member)
                reporter.progress("unpack", number, len(members))
            Session.open(unfinished / top)
            return (unfinished / top).rename(free_folder(root, top))
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _keep_time(path: Path, member: ZipInfo) -> None:
    """Give a file its old time: a report must not look older than what it reports."""
    with suppress(OSError, OverflowError, ValueError):
        seconds = time.mktime((*member.date_time, 0, 0, -1))
        utime(path, (seconds, seconds))

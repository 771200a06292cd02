"""Files that appear whole or not at all, whatever happens to the process, the disk or the clock."""

from __future__ import annotations

import os
import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LEFTOVER = re.compile(r"\..+\.(?P<host>[^.]+)\.(?P<process>\d+)")
PROBE = 2**20  # bytes that show why a file could not be written


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A path to write beside the real one, which it replaces when all went well and leaves alone otherwise.

    The folder is made where there is none; a link is followed.
    """
    check_target(path)
    path = Path(os.path.realpath(path))
    beside = path.with_name(f".{path.name}.{_host()}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        yield beside
        os.replace(beside, path)
    except (OSError, RuntimeError) as error:  # of netCDF, which calls a full disk "HDF error" or "Permission denied"
        _check_space(beside, path)
        if isinstance(error, OSError) and str(error.filename) == str(beside):  # as where the path is a folder
            raise _unwritable(path, error) from None
        raise
    finally:
        with suppress(OSError):
            beside.unlink()


def write_text(path: str | Path, text: str) -> None:
    """Write a file of text, and the folder that it stands in."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def check_target(path: str | Path) -> None:
    """Refuse a path that no file can have, such as that of a folder or a device, or one below a file."""
    path = Path(path)
    try:
        folder = next(parent for parent in path.absolute().parents if parent.exists())
        if path.is_dir():
            wrong = "it is a folder"
        elif path.exists() and not path.is_file():
            wrong = "it is a device"  # which a file would replace
        elif not folder.is_dir():
            wrong = f"{folder} is not a folder"
        elif not os.access(folder, os.W_OK):
            wrong = f"{folder} is closed to writing"
        else:
            return
    except OSError as error:  # such as a name that is too long
        wrong = f"{error.strerror}"
    raise OSError(f"{path} cannot be written ({wrong}): name another file, in a folder that you can write to")


def check_writable(folder: str | Path) -> None:
    """Refuse to start where nothing can be written."""
    if Path(folder).exists() and not os.access(folder, os.W_OK):
        raise OSError(f"{folder} cannot be written to: open it for writing, or work in a copy of the checkout")


def remove_leftovers(folder: str | Path) -> None:
    """Remove what processes of this machine that were killed had half written below a folder."""
    for path in Path(folder).rglob(".*"):
        leftover = LEFTOVER.fullmatch(path.name)
        if leftover and leftover["host"] == _host() and not _runs(int(leftover["process"])):
            path.unlink(missing_ok=True)


def bring_to_present(*folders: str | Path) -> None:
    """Give files that are dated in the future the time of now: a clock that went back leaves them new for ever."""
    now = time.time()
    for folder in folders:
        for path in Path(folder).rglob("*"):
            with suppress(FileNotFoundError):
                if path.lstat().st_mtime > now:
                    os.utime(path, follow_symlinks=False)


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except OSError as error:  # one of another user may not be asked
        return isinstance(error, PermissionError)
    return True


def _host() -> str:
    return socket.gethostname().partition(".")[0]


def _check_space(beside: Path, path: Path) -> None:
    """Say why nothing can be written, if that is so."""
    try:
        with beside.open("ab") as file:
            file.write(bytes(PROBE))
    except OSError as error:
        raise _unwritable(path, error) from None


def _unwritable(path: Path, error: OSError) -> OSError:
    """The error in terms of the file that was asked for, not of the one beside it."""
    return OSError(f"{path} cannot be written: {error.strerror}; mend that and run again")

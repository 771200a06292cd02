"""Write files atomically, with clear errors for a full disk and for paths that cannot be written."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import NamedTemporaryFile

from weier.checks import readable


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path in the same folder, which replaces the given one unless an error is raised.

    A missing folder is made, and a link is followed.
    """
    check_target(path)
    path = Path(os.path.realpath(path))
    host = socket.gethostname().partition(".")[0]
    temporary = path.with_name(f".{path.name}.{host}.{os.getpid()}")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield temporary
        os.replace(temporary, path)
    except (OSError, RuntimeError):  # netCDF calls a full disk "HDF error" or "Permission denied".
        try:
            with temporary.open("ab") as file:
                file.write(bytes(2**20))
        except OSError as error:
            raise OSError(f"{path} cannot be written: {error.strerror}; fix this and rerun") from None
        raise
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_text(path: str | Path, text: str) -> None:
    """Write a text file atomically, and make its folder if it is missing."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def check_target(path: str | Path) -> None:
    """Refuse a path, or the target of a link, where no file can be written: a folder, a device, or below a file."""
    path = Path(path)
    target = Path(os.path.realpath(path))
    try:
        folder = next(parent for parent in target.parents if parent.exists())
        reasons = {
            "it is a folder": path.is_dir(),
            "it is a device": path.exists() and not path.is_file(),  # a file would replace it
            "netCDF needs a path in UTF-8": path.suffix == ".nc" and readable(str(path)) != str(path),
        }
        if not any(reasons.values()):  # a temporary file of about the same name shows what else prevents writing
            NamedTemporaryFile(dir=folder, prefix=f".{target.name}.").close()
    except OSError as error:  # for example, the name is too long
        reasons = {str(error.strerror): True}
    for reason in (reason for reason, holds in reasons.items() if holds):
        raise OSError(f"{path} cannot be written ({reason}): name another file, in a folder that you can write to")

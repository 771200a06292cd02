"""The command line as a shell sees it, in this process."""

import sys

import pytest

from weier import cli


@pytest.fixture
def run(monkeypatch, capsys):
    """Run a command: its exit code, output and errors."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["weier", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        answer = capsys.readouterr()
        return stopped.value.code or 0, answer.out, answer.err

    return run

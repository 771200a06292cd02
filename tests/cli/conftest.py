"""The command line as a shell sees it, in this process."""

import signal
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
        answer, code = capsys.readouterr(), stopped.value.code or 0
        # Python prints a message that is an exit code.
        return (1, answer.out, f"{answer.err}{code}\n") if isinstance(code, str) else (code, answer.out, answer.err)

    before = {sent: signal.getsignal(sent) for sent in (signal.SIGINT, signal.SIGTERM)}
    yield run
    for sent, handler in before.items():
        signal.signal(sent, handler)

import json
import re
from dataclasses import dataclass

import pytest

from hitjoints.cli import main


@dataclass
class Outcome:
    code: int
    out: str
    err: str

    @property
    def json(self):
        # One object on stdout and nothing else.
        return json.loads(self.out)

    @property
    def words(self):
        """What was printed, on one line and without box drawing."""
        return re.sub(r"\s+", " ", self.out)


@pytest.fixture
def run(capsys):
    """Run a command line in this process, as the `hitjoints` script does."""

    def call(*arguments: object) -> Outcome:
        with pytest.raises(SystemExit) as leaving:
            main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        code = leaving.value.code
        return Outcome(code if isinstance(code, int) else 1, printed.out, printed.err)

    return call

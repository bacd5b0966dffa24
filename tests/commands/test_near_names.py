"""A misspelt command or option is refused with the nearest one."""

import pytest

from teleopdesign.cli import main


@pytest.mark.parametrize(
    "arguments, near",
    [
        (["diagnos", "folder"], 'did you mean "diagnose"?'),
        (["design", "folder", "--bandwith", "60"], 'did you mean "--bandwidth"?'),
        (["design", "folder", "--bandwith=60"], 'did you mean "--bandwidth"?'),
    ],
)
def test_the_nearest_command_or_option_is_named(arguments, near, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert near in capsys.readouterr().err

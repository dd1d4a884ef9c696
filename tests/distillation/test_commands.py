"""What `jaxleas distill` shows on its way."""

from jaxleas.distillation.commands import _Teller


def test_every_stage_is_shown_and_of_many_in_a_row_some(capsys):
    say = _Teller()
    say("round 1: one epoch of practice judges itself")  # a stage, whatever words it is in
    for count in range(1000):
        say(f"{count}", passing=True)
    say("round 1: an epoch of labels")
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["round 1: one epoch of practice judges itself", "round 1: an epoch of labels"]
    say.PAUSE = 0.0
    say("7 guide paths", passing=True)
    assert capsys.readouterr().out == "7 guide paths\n"

import json

import pytest

from jaxleas.evaluation.result_file import (
    AreaResult,
    CellResult,
    Evaluation,
    now,
    read_evaluation,
    write_evaluation,
)
from jaxleas.types import InputError

SECTION_7 = {
    "name", "yaw", "method", "planner", "starts", "reached", "invalid", "stopped", "planned",
    "robustness", "mean_step", "low", "high",
}  # fmt: skip


def an_evaluation() -> Evaluation:
    cell = CellResult(
        name="bridge",
        yaw=180.0,
        method="leas_p1",
        starts=100,
        reached=0.87,
        invalid=0.1,
        stopped=0.03,
        low=0.79,
        high=0.92,
        mean_time=61.2,
        areas={"near": AreaResult(starts=50, reached=0.8, invalid=0.2)},
    )
    return Evaluation(
        suite="transitions", policy="run", robot="talos", seed=0, created=now(), cells=(cell,)
    )


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "deep" / "result.json"
    write_evaluation(path, an_evaluation())
    assert read_evaluation(path) == an_evaluation().model_copy(
        update={"created": read_evaluation(path).created}
    )
    content = json.loads(path.read_text())
    assert {"suite", "policy", "robot", "seed", "created", "cells"} <= content.keys()
    assert content["cells"][0].keys() >= SECTION_7
    assert content["cells"][0]["planner"] is None


def damaged(change):
    content = an_evaluation().model_dump(mode="json")
    change(content)
    return content


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda c: c.pop("suite"), "suite"),
        (lambda c: c["cells"][0].update(reached=1.2), "cells.0.reached"),
        (lambda c: c["cells"][0].update(reached=0.5), "is 0.63, not 1"),
        (lambda c: c["cells"][0].update(low=0.9, high=0.95), "misses its fraction 0.87"),
        (lambda c: c["cells"][0].pop("yaw"), "cells.0.yaw"),
        (lambda c: c["cells"][0].update(reachd=0.5), "cells.0.reachd"),
        (lambda c: c["cells"][0].update(starts=0), "cells.0.starts"),
        (lambda c: c.update(version=2), "version"),
    ],
)
def test_what_is_no_evaluation_is_refused_by_key(tmp_path, change, said):
    path = tmp_path / "result.json"
    path.write_text(json.dumps(damaged(change)))
    with pytest.raises(InputError, match=said) as caught:
        read_evaluation(path)
    assert str(path) in str(caught.value)


def test_other_json_and_missing_files_are_refused(tmp_path):
    path = tmp_path / "list.json"
    path.write_text("[]")
    with pytest.raises(InputError, match="no evaluation"):
        read_evaluation(path)
    with pytest.raises(InputError, match="does not exist"):
        read_evaluation(tmp_path / "none.json")

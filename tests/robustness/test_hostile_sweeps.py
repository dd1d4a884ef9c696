"""What a stranger puts into the folder of a sweep or a population is refused by one sentence."""

import pytest

from jaxleas.files import read_json, write_json
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.history import read_history
from jaxleas.sweeps.job_files import read_job, read_outcome
from jaxleas.sweeps.population_config import open_population
from jaxleas.sweeps.population_folder import hold_population
from jaxleas.sweeps.study import RESULT, Study, read_results
from jaxleas.types import InputError
from tests.sweeps.files import write_population, write_sweep


@pytest.mark.parametrize(
    ("name", "content", "read", "said"),
    [
        ("seed_0.json", {"state": "done"}, lambda p: read_outcome(p.with_suffix("")), "values"),
        ("job.json", {"trainings": [3], "objectives": []}, read_job, "trainings.0: "),
        ("job.json", [], read_job, "is no job of a sweep"),
        ("results.json", [], lambda p: read_results(p.parent), "holds no results of a sweep"),
        ("results.json", {"trials": [{}]}, lambda p: read_results(p.parent), "0.number: "),
        ("results.json", {"version": 7}, lambda p: read_results(p.parent), "of version 7"),
        ("history.jsonl", {"step": 3}, read_history, "line 1 is not valid JSON"),
    ],
)
def test_files_of_a_sweep(tmp_path, name, content, read, said):
    write_json(tmp_path / name, content)
    with pytest.raises(InputError) as refusal:
        read(tmp_path / name)
    assert "\n" not in str(refusal.value)
    assert name in str(refusal.value)
    assert said in str(refusal.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [([], "sweep.json is no record"), ({"trials": [], "version": 2}, "of version 2")],
)
def test_the_record_of_a_sweep(tmp_path, content, said):
    sweep = open_sweep(write_sweep(tmp_path))
    open_folder(tmp_path / "out", sweep).close()
    write_json(tmp_path / "out" / "sweep.json", content)
    with pytest.raises(InputError, match=said):
        open_folder(tmp_path / "out", sweep)


def test_the_memory_of_a_sweep(tmp_path):
    pytest.importorskip("optuna", reason="the extra sweep is not installed")
    sweep = open_sweep(write_sweep(tmp_path))
    folder = open_folder(tmp_path / "out", sweep)
    study = Study(sweep, folder, None)
    trial = study.ask()
    study.draw(trial)
    trial.set_user_attr(RESULT, {"number": 0, "strange": 1})
    study._study.tell(trial, 0.5)
    with pytest.raises(InputError, match="trial 0 of the storage: state: Field required"):
        study.results()
    folder.close()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda record: record["members"][0].update(seed="x"), r"members.0: seed is "),
        (lambda record: record.pop("vary"), "vary: Field required"),
        (lambda record: record.update(version=9), "of version 9"),
    ],
)
def test_the_record_of_a_population(tmp_path, change, said):
    members, file = open_population(write_population(tmp_path)), tmp_path / "out/population.json"
    with hold_population(tmp_path / "out", members):
        pass
    record = read_json(file)
    change(record)
    write_json(file, record)
    with pytest.raises(InputError, match=said) as refusal, hold_population(file.parent, members):
        pass
    assert "\n" not in str(refusal.value)

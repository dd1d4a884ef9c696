from pathlib import Path
from typing import Annotated, Literal, Self

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field, model_validator

from jaxleas.configuration.loading import load_config, to_yaml
from jaxleas.configuration.strict import Strict
from jaxleas.types.errors import InputError


class Rates(Strict):
    learning_rate: Annotated[float, Field(gt=0.0)] = 3e-4
    """Of Adam."""
    discount: Annotated[float, Field(ge=0.0, le=1.0)] = 0.97
    batch: int = 12
    minibatches: int = 4
    kind: Literal["relu", "tanh"] = "relu"

    @model_validator(mode="after")
    def _divides(self) -> Self:
        if self.batch % self.minibatches:
            raise ValueError(f"batch {self.batch} does not divide into {self.minibatches}")
        return self


class World(Strict):
    size: tuple[int, int] = (5, 30)
    name: str = "arena"
    mirrored: bool = False


class Whole(Strict):
    seed: int = 0
    rates: Rates = Rates()
    world: World = World()
    optional: World | None = None


@pytest.fixture
def load(tmp_path: Path):
    def load_text(text: str, *overrides: str, **others: str) -> Whole:
        for name, other in others.items():
            (tmp_path / f"{name}.yaml").write_text(other)
        (tmp_path / "c.yaml").write_text(text)
        return load_config(Whole, tmp_path / "c.yaml", overrides)

    return load_text


def refusal(load, text: str, *overrides: str, **others: str) -> str:
    with pytest.raises(InputError) as caught:
        load(text, *overrides, **others)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


@given(
    st.builds(
        Whole,
        seed=st.integers(-(2**40), 2**40),
        rates=st.builds(Rates, learning_rate=st.floats(1e-30, 1e30), discount=st.floats(0.0, 1.0)),
        world=st.builds(
            World, name=st.text(st.characters(codec="utf-8", exclude_categories=("C",)))
        ),
    )
)
def test_what_is_written_reads_back_equal(tmp_path_factory, config: Whole) -> None:
    path = tmp_path_factory.mktemp("configs") / "c.yaml"
    path.write_text(to_yaml(config), encoding="utf-8")
    assert load_config(Whole, path) == config


@pytest.mark.parametrize("name", ["3e-4", "1E5", "yes", "null", "010", "12:30", "", "- a", "1.0"])
def test_text_that_looks_like_something_else_stays_text(tmp_path: Path, name: str) -> None:
    config = Whole(world=World(name=name))
    (tmp_path / "c.yaml").write_text(to_yaml(config))
    assert load_config(Whole, tmp_path / "c.yaml") == config
    assert load_config(Whole, tmp_path / "c.yaml", ["--world.name", name]) == config


def test_file_then_command_line(load) -> None:
    config = load(
        "seed: 4\nrates: {learning_rate: 5e-4}\n",
        *("--rates.discount=0.5", "--rates.discount", "0.9", "--world.size", "[2, 3]"),
        *("--world.mirrored", "true", "--seed", "-1", "--rates.learning-rate", "1e-3"),
    )
    assert config == Whole(
        seed=-1,
        rates=Rates(learning_rate=1e-3, discount=0.9),
        world=World(size=(2, 3), mirrored=True),
    )


def test_numbers_without_a_dot_are_numbers(load) -> None:
    assert load("rates: {learning_rate: 5e-4}").rates.learning_rate == 5e-4


def test_an_extending_file_states_only_what_differs(load) -> None:
    config = load(
        "extends: b.yaml\nrates: {discount: 0.5}",
        b="extends: a.yaml\nrates: {learning_rate: 1.0}\nseed: 2",
        a="seed: 1\nworld: {name: far}",
    )
    assert config == Whole(
        seed=2, rates=Rates(learning_rate=1.0, discount=0.5), world=World(name="far")
    )


def test_mistakes_in_an_extended_file_name_that_file(load) -> None:
    sentence = refusal(load, "extends: base.yaml\nseed: 1", base="rates: {discount: 1.5}")
    assert "base.yaml: rates.discount is 1.5" in sentence
    assert "less than or equal to 1" in sentence


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("sede: 1", ["c.yaml", "sede", "meant seed"]),
        ("rates: {lerning_rate: 1.0}", ["c.yaml", "rates.lerning_rate", "meant rates.learning_"]),
        ("learning_rate: 1.0", ["meant rates.learning_rate"]),
        ("optional: {sise: [1, 2]}", ["optional.sise", "meant optional.size"]),
        ("zzzzqqq: 1", ["zzzzqqq", "there are seed, rates, world, opt"]),
        ("rates: {discount: 1.5}", ["c.yaml", "rates.discount is 1.5", "less than or equal to 1"]),
        ("rates: {discount: .nan}", ["rates.discount is nan", "finite"]),
        ("rates: {learning_rate: 0}", ["rates.learning_rate is 0", "greater than 0"]),
        ("rates: {kind: swish}", ["rates.kind is 'swish'", "'relu' or 'tanh'"]),
        ("seed: '3'", ["seed is '3'", "valid integer"]),
        ("seed: 1.5", ["seed is 1.5", "integer"]),
        ("seed: true", ["seed is True", "integer"]),
        ("rates: 3", ["rates is 3", "object"]),
        ("world: {size: [1]}", ["c.yaml: world.size.1", "missing"]),
        ("rates: {batch: 10}", ["c.yaml: rates: batch 10 does not divide into 4"]),
        ("seed: 1\nseed: 2", ["c.yaml", "'seed' is given twice", "line 2"]),
        ("rates: {discount: 1.0, discount: 0.5}", ["'discount' is given twice"]),
        ("seed: [1", ["c.yaml", "not a usable YAML", "line 1"]),
        ("", ["c.yaml is empty"]),
        ("- 1", ["c.yaml holds a list"]),
        ("1: 2", ["the key 1 is no name"]),
        ("extends: 3", ["extends is 3"]),
        ("extends: nowhere.yaml", ["nowhere.yaml does not exist"]),
        ("extends: c.yaml", ["extends itself"]),
        ("seed: !!python/object/apply:os.getcwd []", ["c.yaml", "could not determine"]),
    ],
)
def test_a_mistake_in_a_file_is_one_sentence(load, text: str, expected: list[str]) -> None:
    sentence = refusal(load, text)
    assert all(part in sentence for part in expected), sentence


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["--sede", "1"], ["command line", "there is no --sede", "meant --seed"]),
        (["--rates.discont=1"], ["meant --rates.discount"]),
        (["--discount", "1"], ["meant --rates.discount"]),
        (["--seed"], ["--seed needs a value"]),
        (["--seed", "--rates.batch", "8"], ["--seed needs a value"]),
        (["seed=3"], ["'seed' stands alone"]),
        (["--seed", "1", "2"], ["'2' stands alone"]),
        (["--rates.discount", "2"], ["command line: rates.discount is 2", "less than or equal"]),
        (["--rates.batch", "10"], ["rates: batch 10 does not divide"]),
        (["--seed", "[1"], ["--seed [1 is not YAML"]),
        (["--seed", "abc"], ["command line: seed is 'abc'", "integer"]),
        (["--world.zzz", "1"], ["no --world.zzz", "there are world.size, world.name"]),
        (["--sede", "1", "--seed"], ["--sede"]),
    ],
)
def test_a_mistake_on_the_command_line_is_one_sentence(load, overrides, expected) -> None:
    sentence = refusal(load, "seed: 1", *overrides)
    assert all(part in sentence for part in expected), sentence


def test_several_mistakes_are_counted(load) -> None:
    assert "(and 1 more)" in refusal(load, "sede: 1\nwrld: 2")


def test_a_missing_file_and_a_folder_are_named(tmp_path: Path) -> None:
    for path in (tmp_path / "nowhere.yaml", tmp_path):
        with pytest.raises(InputError, match=str(path)):
            load_config(Whole, path)


@pytest.mark.parametrize("name", ["a\0b.yaml", "a" * 300 + ".yaml"])
def test_what_is_no_name_of_a_file_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="does not exist"):
        load_config(Whole, name)


def test_help_shows_every_field_with_its_value_and_docstring(load, capsys) -> None:
    with pytest.raises(SystemExit) as caught:
        load("rates: {discount: 0.25}", "--help")
    text = capsys.readouterr().out
    assert caught.value.code == 0
    assert all(part in text for part in ("--rates.discount float  [0.25]", "Of Adam.", "relu|tanh"))

"""The documentation says what is: links resolve, commands parse, code runs, fields are there."""

import ast
import functools
import importlib
import re
import runpy
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import jax.numpy as jnp
import pytest

from jaxleas import cli
from jaxleas.configuration.fields import fields_of
from jaxleas.configuration.loading import to_yaml
from jaxleas.envs.steering.layout import FEELERS169, ICRA81, THESIS144
from jaxleas.files import config_file
from jaxleas.runs.folder import RunFolder
from jaxleas.runs.metrics import read_metrics
from jaxleas.terrain import write_height_map
from jaxleas.training.policy import write_policy
from jaxleas.training.run_config import load_run_config, run_config_of
from tests.guide.walkers import flat_map, random_policy, standing
from tests.training.runs import tiny

ROOT = Path(__file__).resolve().parents[1]
RunConfig = run_config_of("steering")
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
PAGES = [*(ROOT / name for name in TOP), *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```(\w*)(?: [^\n]*)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
RUNS = re.compile(r"^<!-- (runs.*?) -->\n```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def name_of(value: object) -> str:
    return str(value.relative_to(ROOT)) if isinstance(value, Path) else str(value)


each_page = pytest.mark.parametrize("page", PAGES, ids=name_of)


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as they are made on GitHub."""
    prose = FENCE.sub("", page.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ (.*)$", prose, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each.lower()).replace(" ", "-") for each in headings}


@each_page
def test_relative_links_resolve(page: Path) -> None:
    prose = FENCE.sub("", page.read_text(encoding="utf-8"))
    targets = re.findall(r"\]\(([^)]+)\)", prose)
    assert [each for each in targets if not resolves(page, each)] == []


def test_the_index_of_decisions_names_every_topic() -> None:
    index, *topics = re.split(r"^## ", (ROOT / "docs/decisions.md").read_text("utf-8"), flags=re.M)
    named = [each.partition("\n")[0] for each in topics]
    assert [each for each in named if f"[{each}](#" not in index] == []


def test_every_page_has_its_place_in_the_index() -> None:
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    names = {page.name for page in PAGES if page.parent.name == "docs"} - {"index.md"}
    assert {name for name in names if f"]({name}" not in index} == set()


def test_the_glossary_is_in_alphabetical_order() -> None:
    text = (ROOT / "docs/glossary.md").read_text(encoding="utf-8")
    entries = re.findall(r"^- \*\*(.*?)\.\*\*", text, re.MULTILINE)
    words = [re.findall(r"\w+", each.lower()) for each in entries]
    assert words == sorted(words)


def test_the_readme_is_read_in_three_minutes() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.split()) <= 900


def resolves(page: Path, target: str) -> bool:
    if target.startswith("https://"):
        return True
    name, _, anchor = target.partition("#")
    linked = (page.parent / name).resolve() if name else page
    return linked.is_file() and (not anchor or anchor in anchors(linked))


def commands(page: Path) -> Iterator[str]:
    """Yield the shell commands of a page: of its sh blocks, and indented ones."""
    text = page.read_text(encoding="utf-8")
    blocks = [body for language, body in FENCE.findall(text) if language == "sh"]
    blocks += re.findall(r"^    (python .*)$", text, re.MULTILINE)
    for line in "\n".join(blocks).replace("\\\n", " ").splitlines():
        if line.strip():
            yield line


def inline_commands(page: Path) -> Iterator[str]:
    """Yield what a sentence quotes of a command; it may leave out what is needed to run."""
    prose = FENCE.sub("", page.read_text(encoding="utf-8"))
    yield from re.findall(r"`((?:jaxleas|python|make) [^`]+)`", prose)


ALL_COMMANDS = sorted({(page, line) for page in PAGES for line in commands(page)})


@pytest.mark.parametrize(("page", "line"), ALL_COMMANDS, ids=name_of)
def test_commands_parse(page: Path, line: str, monkeypatch) -> None:
    words = shlex.split(line, comments=True)
    while re.fullmatch(r"[A-Z_]+=.*", words[0]):  # variables of the environment
        words.pop(0)
    match words:
        case ["jaxleas", "train", *arguments]:
            parse_train(arguments, page, monkeypatch)
        case ["jaxleas", *arguments]:
            assert parse_jaxleas(arguments, monkeypatch), line
        case ["python", "train.py", *arguments]:
            parse_train(arguments, page, monkeypatch)
        case ["python", "-m", "jaxleas", *arguments]:
            assert parse_jaxleas(arguments, monkeypatch), line
        case ["python", "-m", "venv" | "pytest", *_]:
            pass
        case ["python", "-m", module, *arguments]:
            file = ROOT / module.replace(".", "/")
            file = file / "__main__.py" if file.is_dir() else file.with_suffix(".py")
            source = file.read_text(encoding="utf-8")
            for option in (each for each in arguments if each.startswith("--")):
                assert f'"{option}"' in source, f"{module} has no {option}"
        case ["python", script, *arguments]:
            source = (ROOT / script).read_text(encoding="utf-8")
            for beside in (ROOT / script).parent.glob("*.py"):  # the module that it hands over to
                if f"from {beside.stem} import" in source:
                    source += beside.read_text(encoding="utf-8")
            for option in (each for each in arguments if each.startswith("--")):
                assert f'"{option}"' in source, f"{script} has no {option}"
        case ["make", target, *variables]:
            require_make(target, variables)
        case ["source", ".venv/bin/activate"] | ["git", "clone", *_]:
            pass
        case ["pip", "install" | "wheel", *_]:
            pass
        case _:
            pytest.fail(f"{page.name}: this test does not know how to read {line!r}")


def parse_jaxleas(arguments: list[str], monkeypatch) -> list[dict]:
    """Parse a command with its own parser; return what its function would have been given."""
    given: list[dict] = []

    def stub(function):
        def take(*words, **options):
            given.append({**options, "words": words})

        return functools.wraps(function)(take)

    def import_stub(module: str) -> SimpleNamespace:
        names = [function for room, function, _ in cli.COMMANDS.values() if room == module]
        real = importlib.import_module(module)
        return SimpleNamespace(**{name: stub(getattr(real, name)) for name in names})

    monkeypatch.setattr(cli, "import_module", import_stub)
    cli.run(arguments)
    return given


def parse_train(arguments: list[str], page: Path, monkeypatch) -> None:
    (given,) = parse_jaxleas(["train", *arguments], monkeypatch)
    config, *overrides = given["words"]
    assert (config is None) != (given["resume"] is None)
    if config is None:
        assert not overrides
    elif f"<!-- file: {config} -->" not in page.read_text(encoding="utf-8"):
        # a file of the page's own is read where it is run
        overrides = [each for each in overrides if each != "--help"]
        load_run_config(config_file(config, ROOT), overrides)


def require_make(target: str, variables: list[str]) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(rf"^{target}:", makefile, re.MULTILINE), f"no target {target}"
    for name, _, value in (each.partition("=") for each in variables):
        assert re.search(rf"^{name} \?=", makefile, re.MULTILINE), f"no variable {name}"
        assert not value.endswith(".yaml") or (ROOT / value).is_file()


@each_page
def test_quoted_commands_exist(page: Path) -> None:
    for quoted in inline_commands(page):
        words = quoted.split()
        options = [each for each in words if each.startswith("--")]
        if words[0] == "make":
            require_make(words[1], words[2:])
        elif words[1] in ("train.py", "train"):
            names = {f"--{field.name}" for field in fields_of(RunConfig)}
            assert {*options} <= names | {"--resume", "--run-dir", "--help"}, quoted
        elif words[0] == "jaxleas" and not words[1].startswith("-"):
            name = " ".join(words[1:3]) if " ".join(words[1:3]) in cli.COMMANDS else words[1]
            assert name in cli.COMMANDS, f"{page.name}: there is no command {quoted!r}"
            assert {*options} <= options_of(name), quoted


def options_of(command: str) -> set[str]:
    module, function, _ = cli.COMMANDS[command]
    parser = cli._Parser()
    cli.add_options(parser, getattr(importlib.import_module(module), function))
    return {option for action in parser._actions for option in action.option_strings}


@each_page
def test_python_blocks_compile(page: Path) -> None:
    for language, body in FENCE.findall(page.read_text(encoding="utf-8")):
        if language == "python":
            ast.parse(body)


@pytest.fixture
def workplace(tmp_path, monkeypatch) -> Path:
    """A folder with what the examples find: a run with a policy, a terrain, the configurations."""
    with RunFolder.create(tmp_path / "runs/leas_p1", to_yaml(RunConfig()), ["train.py"]) as run:
        write_policy(run.path / "policy.npz", random_policy())
    write_height_map(tmp_path / "terrain.npz", flat_map(half_size=6.0))
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def execute(page: str, slow: bool = False) -> dict:
    """Run the marked blocks of a page in the present folder; return the names that they made."""
    programs: list[str] = []
    for mark, body in RUNS.findall((ROOT / page).read_text(encoding="utf-8")):
        if "after the block above" not in mark:
            programs.append(body)
        elif slow:
            programs[-1] += body
    names: dict = {}
    for program in programs:
        Path("example.py").write_text(program, encoding="utf-8")
        names = runpy.run_path("example.py")
    return names


def test_the_readme_example_walks(workplace: Path, capsys) -> None:
    names = execute("README.md")
    assert len(names["path"]) > 1
    assert re.fullmatch(
        r"\d+ configurations, \d+\.\d\d m, reached: (True|False)\n", capsys.readouterr().out
    )


def test_the_examples_for_your_own_run(workplace: Path) -> None:
    names = execute("docs/your_own.md")
    assert (workplace / "stairs.npz").is_file()
    assert (workplace / "robots/walker.json").is_file()
    require_level_means_level(names["env"])


def require_level_means_level(env) -> None:
    """Require that the condition of the example refuses a step under the trunk, and only that."""
    motion = standing(env, [(0.0, 0.0)])
    level = jnp.full((1, len(env.points_in_root)), -env.robot.walking_height)
    assert env.condition(level, motion)[0] > 0.0
    ahead = level.at[:, env.layout.size - 5].add(0.3)  # the observation's last point: unjudged
    assert env.condition(ahead, motion)[0] > 0.0
    assert env.condition(level.at[:, -1].add(-0.3), motion)[0] < 0.0


@pytest.mark.slow
def test_the_training_example_trains(workplace: Path, brax_ranks) -> None:
    execute("docs/your_own.md", slow=True)
    assert (workplace / "level_policy.npz").is_file()


def test_every_field_is_documented() -> None:
    text = (ROOT / "docs/training.md").read_text(encoding="utf-8")
    missing = [
        field.name
        for field in fields_of(RunConfig)
        if field.section is None
        and not field.name.startswith("terrain.generator.")
        and f"`{field.name}`" not in text
    ]
    assert not missing
    known = {field.name for field in fields_of(RunConfig)}
    stated = set(re.findall(r"`((?:env|ppo|network|held_out|final|terrain)\.[\w.]+)`", text))
    assert not stated - known, "fields that do not exist"


def test_the_layouts_are_documented() -> None:
    text = (ROOT / "docs/observations_and_actions.md").read_text(encoding="utf-8")
    for layout in (THESIS144, FEELERS169, ICRA81):
        rows = ", ".join(f"{x:g}" for x in layout.rows)
        shape = f"{len(layout.rows)} x {len(layout.columns)}"
        assert f"| `{layout.name}` | {layout.size} | {shape} | {rows} |" in text
        assert f"{layout.columns[0]:g} to {layout.columns[-1]:g} in steps of" in text


@pytest.mark.slow
def test_every_metric_is_documented(tmp_path, brax_ranks) -> None:
    from jaxleas.training.loop import train

    with RunFolder.create(tmp_path / "run", to_yaml(tiny()), ["train.py"]) as run:
        train(tiny(), run)
    documented = re.findall(r"`([\w/]+\*?)`", (ROOT / "docs/training.md").read_text("utf-8"))
    exact = {name for name in documented if not name.endswith("*")}
    families = tuple(name[:-1] for name in documented if name.endswith("*"))
    logged = {name for row in read_metrics(run.metrics) for name in row}
    assert not {name for name in logged - exact if not name.startswith(families)}
    stated = {name for name in exact if name.startswith(("walk/", "learn/", "held_out/"))}
    by_kind = {"held_out/worst"}  # logged where `terrain.examined` is `all`, which this run is not
    assert not stated - logged - by_kind, "metrics that do not exist"

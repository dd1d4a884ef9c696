"""Status is a value: no code looks for words in a sentence that was written for a person."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import jaxleas

ROOT = Path(jaxleas.__file__).parent
SENTENCES = {"reason", "message", "words", "sentence", "problem", "complaint", "trouble"}
LOOKS = {"startswith", "endswith", "partition", "find", "index", "count"}


def is_sentence(node: ast.expr) -> bool:
    """Whether an expression is a sentence by its name, or an exception as text."""
    if isinstance(node, ast.Call):
        named_error = node.args and isinstance(node.args[0], ast.Name)
        of_error = named_error and node.args[0].id in ("error", "exception")  # type: ignore[attr-defined]
        return isinstance(node.func, ast.Name) and node.func.id == "str" and bool(of_error)
    name = getattr(node, "attr", getattr(node, "id", ""))
    return isinstance(node, ast.Attribute | ast.Name) and name in SENTENCES


def looks_for_words(source: str) -> Iterator[int]:
    """Yield the lines on which a sentence is searched for words or compared with them."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Compare) and isinstance(node.left, ast.Constant):
            searched = isinstance(node.ops[0], ast.In | ast.NotIn)
            if searched and is_sentence(node.comparators[0]):
                yield node.lineno
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and node.func.attr in LOOKS
            and is_sentence(node.func.value)
        ):
            yield node.lineno


@pytest.mark.parametrize("path", sorted(ROOT.rglob("*.py")), ids=lambda path: path.stem)
def test_no_sentence_is_searched_for_words(path: Path) -> None:
    assert not list(looks_for_words(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("'neither foot' in walked.reason", [1]),
        ("if 'in use by' not in str(error): pass", [1]),
        ("counts = ' of ' in words", [1]),
        ("plan.reason.partition(': ')", [1]),
        ("str(error).startswith('x')", [1]),
        ("'mip' in planners; plan.status == 'late'; str(path).endswith('x')", []),
    ],
)
def test_a_search_for_words_is_found(source: str, found: list[int]) -> None:
    assert list(looks_for_words(source)) == found

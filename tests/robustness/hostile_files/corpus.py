"""A small valid file of every kind."""

from pathlib import Path

from tests.robustness.hostile_files.contact_kinds import contact_kinds
from tests.robustness.hostile_files.guide_kinds import guide_kinds
from tests.robustness.hostile_files.judgement_kinds import judgement_kinds
from tests.robustness.hostile_files.kinds import Kind
from tests.robustness.hostile_files.learned_kinds import learned_kinds
from tests.robustness.hostile_files.run_kinds import run_kinds
from tests.robustness.hostile_files.sweep_kinds import sweep_kinds
from tests.robustness.hostile_files.terrain_kinds import terrain_kinds


def make_corpus(folder: Path) -> list[Kind]:
    """Write the valid files below a folder, mostly with the package's own writers."""
    folder.mkdir(parents=True, exist_ok=True)
    makers = (
        *(terrain_kinds, guide_kinds, learned_kinds, contact_kinds),
        *(run_kinds, judgement_kinds, sweep_kinds),
    )
    return [kind for make in makers for kind in make(folder)]

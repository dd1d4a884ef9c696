"""Ranges of seeds for terrain: training never sees the terrain of evaluation."""

# Four disjoint ranges of seeds. A training configuration is refused a first seed beyond
# its range; held-out terrain (checkpoint choice), tuning terrain (named scenarios, judged again and
# again while a policy is refined) and evaluation terrain (reported numbers) differ too, so that no
# choice can leak into the number that is reported for it.
MAX_TRAINING_SEED = 900_000
HELD_OUT_SEED = 1_000_000
TUNING_SEED = 1_500_000
EVALUATION_SEED = 2_000_000

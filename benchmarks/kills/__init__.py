"""The commands of tests/robustness/kills, under the names that committed results carry."""

"""The command of tests/robustness/hostile_files, under the name that committed results carry."""

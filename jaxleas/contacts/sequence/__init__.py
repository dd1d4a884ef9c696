"""Contact plans in time, for programs of others: footsteps, contact sequences, schedules."""

"""Pages that people read: reports, players, README, and whether their statements agree."""

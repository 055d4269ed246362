"""Sample runs, small enough for git; see README.md here. Data only."""

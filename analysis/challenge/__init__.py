"""The blind challenge: runs with concealed physics, diagnosed without the answer, then scored."""

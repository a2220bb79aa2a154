"""The robot: connect, plan, check, let it pour, and say what became of the candies."""

"""The outcome of a pour in simulation: the driven path moves a cup of candies over the true object."""

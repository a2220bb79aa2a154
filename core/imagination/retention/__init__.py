"""How firmly an object holds: the tilt and the sideways acceleration at which candies leave it."""

"""How much fits: imagined filling, and the geometric volume beside it."""

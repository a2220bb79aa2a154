"""`python -m app.cli`: the same as the command `poursight`."""

from app.cli.program import main

main()

"""The page that shows what was imagined: the drop replayed, its verdict, and the parameters behind it."""

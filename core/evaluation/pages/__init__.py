"""The pages for people: an evaluation's report, and the comparison of two. jinja2 and PIL are loaded late."""

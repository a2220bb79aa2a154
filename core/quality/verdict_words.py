"""The verdicts on a scan, and the file that holds one; light to import."""

GOOD, USABLE, AGAIN = "good", "usable", "scan again"
VERDICTS = (GOOD, USABLE, AGAIN)
FACTS_FILE = "quality.json"

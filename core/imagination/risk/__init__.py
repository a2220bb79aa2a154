"""How surely each pour spills nothing: pours imagined again with errors of the set-up."""

"""How surely each pour spills nothing: drawing errors, spending tries, and what they say."""

"""Editing the method's parameters: one row each, checked by the schema, compared with a preset."""

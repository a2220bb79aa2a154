"""The Cell page: from a bare table to a calibrated cell, step by step."""

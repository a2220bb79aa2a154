"""The use cases, without a front end: what has to be asked is asked through a protocol."""

"""Fitting parameters to objects whose answer is known (Sec. IV-C): by search instead of by hand."""

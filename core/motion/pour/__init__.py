"""The pour as a motion of the arm: from the cup's station to the imagined pour and back, checked."""

"""What people touch: the command line and the desktop."""

import os

# NumPy reads it when it is first imported, which every way into the program does later than this; processes
# that are started inherit it. All processors are busy with workers of ours: threads of a matrix product
# would wait for each other longer than they compute (decision 0043).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

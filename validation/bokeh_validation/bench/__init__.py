"""Table 1 of the paper on this machine: how long the methods take, against naive, against each other, and against a
floor that makes the same fetches. `validation/run bench`.
"""

"""Readers of log files, one "door" per format: csv, parquet, xlsx, mat, npz, h5, json and ROS bags.

A door opens a file as a `Log`: the names of its columns, and a function that reads some of them.
Sizes are checked before the data are read. No code in a file is executed.
"""
